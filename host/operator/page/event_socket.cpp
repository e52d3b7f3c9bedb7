// SPDX-License-Identifier: Apache-2.0
#include "host/operator/page/event_socket.h"

#include <utility>

namespace mixrig::page {

EventSocket::EventSocket(Hub& hub, boost::beast::tcp_stream stream)
    : TextSocket(hub, std::move(stream), kMostMessage) {
  hub_.sockets.insert(this);
}

EventSocket::~EventSocket() { hub_.sockets.erase(this); }

void EventSocket::on_message(const std::string& message) {
  const double host_ms = milliseconds(hub_.clock.now().time_since_epoch());
  send(subscriptions_.answer(message, hub_.state(), host_ms));
}

void EventSocket::tell(const nlohmann::json& state) {
  if (writes()) return;  // it has not read what it was told; the next time is soon
  for (const std::string& part : subscriptions_.changed(state))
    send(changed_message(part, state.at(part)));
}

}  // namespace mixrig::page

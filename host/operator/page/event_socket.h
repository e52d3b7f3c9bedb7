// SPDX-License-Identifier: Apache-2.0
// One client of the event socket. Private to this module.
#pragma once

#include <string>

#include "host/operator/page/events.h"
#include "host/operator/page/text_socket.h"

namespace mixrig::page {

/// Sends the state to one client. A client that reads slowly misses values in between, and gets the
/// newest.
class EventSocket final : public TextSocket {
 public:
  EventSocket(Hub& hub, boost::beast::tcp_stream stream);
  ~EventSocket() override;
  void tell(const nlohmann::json& state);

 private:
  void on_open() override { send(opened_message()); }
  void on_message(const std::string& message) override;

  Subscriptions subscriptions_;
};

}  // namespace mixrig::page

// SPDX-License-Identifier: Apache-2.0
#include "host/operator/page/osc/osc_port.h"

#include <algorithm>
#include <span>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/ip/address.hpp>

#include "host/operator/page/hub.h"
#include "host/operator/page/osc/osc_commands.h"
#include "host/output/datagrams/osc.h"

namespace mixrig::page {

namespace asio = boost::asio;
using asio::ip::udp;

namespace {

constexpr std::size_t kMostSurfaces = 8;

}  // namespace

OscPort::OscPort(Hub& hub) : hub_(hub), socket_(hub.io) {}

Result<void> OscPort::open(const Listen& listen) {
  const udp::endpoint wanted(asio::ip::make_address(listen.address), listen.port);
  boost::system::error_code error;
  socket_.open(wanted.protocol(), error);
  if (!error) socket_.bind(wanted, error);
  if (!error) socket_.non_blocking(true, error);
  if (error)
    return system_error(ErrorCode::kIo,
                        "cannot receive OSC at " + listen.address + ":" +
                            std::to_string(listen.port) + ": choose another one by --osc-in",
                        error.value());
  port_ = socket_.local_endpoint().port();
  has_prefix_ = !wanted.address().is_loopback() || !listen.token_file.empty();
  renew_prefix();
  receive();
  return {};
}

void OscPort::renew_prefix() {
  if (has_prefix_) prefix_ = "/" + (hub_.guard.token.empty() ? random_token() : hub_.guard.token);
}

void OscPort::receive() {
  socket_.async_receive_from(asio::buffer(buffer_), from_,
                             [this](boost::system::error_code error, std::size_t bytes) {
                               if (error == asio::error::operation_aborted) return;
                               if (!error) take(bytes);
                               receive();
                             });
}

bool OscPort::strip_prefix(std::string& address) const {
  if (!equal_in_constant_time(std::string_view(address).substr(0, prefix_.size()), prefix_))
    return false;
  address.erase(0, prefix_.size());
  return true;
}

void OscPort::take(std::size_t bytes) {
  auto messages = stream::parse_osc(std::span(buffer_).first(bytes));
  if (!messages) return;
  for (stream::OscReceived& message : *messages) {
    if (!strip_prefix(message.address)) return;
    act(std::move(message), from_);
  }
}

OscPort::Surface& OscPort::surface(const Endpoint& at) {
  const auto known = std::find_if(surfaces_.begin(), surfaces_.end(),
                                  [&](const Surface& one) { return one.at == at; });
  if (known != surfaces_.end()) return *known;
  if (surfaces_.size() >= kMostSurfaces) surfaces_.pop_front();
  return surfaces_.emplace_back(Surface{at, {}});
}

void OscPort::act(stream::OscReceived message, const Endpoint& from) {
  const nlohmann::json state = hub_.state();
  auto action = action_of(message, state);
  Surface& sender = surface(from);
  const auto tell_fault = [this, from](const Error& error) {
    send(from, stream::OscMessage("/mixrig/error").add(std::string_view(to_line(error))).bytes());
  };
  if (!action) return tell_fault(action.error());
  if (!*action) {
    sender.told.clear();
    return tell(sender, osc_of(state));
  }
  hub_.act(**std::move(action), [tell_fault](const Result<void>& done) {
    if (!done) tell_fault(done.error());
  });
}

void OscPort::send(const Endpoint& to, const std::string& datagram) {
  boost::system::error_code ignored;  // a full buffer, or nobody there: the next change is told
  socket_.send_to(asio::buffer(datagram), to, 0, ignored);
}

void OscPort::tell(Surface& surface, const std::map<std::string, std::string>& now) {
  for (const auto& [address, datagram] : now) {
    std::string& told = surface.told[address];
    if (told == datagram) continue;
    told = datagram;
    send(surface.at, datagram);
  }
}

void OscPort::tell(const nlohmann::json& state) {
  if (surfaces_.empty()) return;
  const auto now = osc_of(state);
  for (Surface& one : surfaces_) tell(one, now);
}

}  // namespace mixrig::page

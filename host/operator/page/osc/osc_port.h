// SPDX-License-Identifier: Apache-2.0
// Receives OSC from control surfaces and sends them the state. Private to this module.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <string>

#include <boost/asio/ip/udp.hpp>
#include <nlohmann/json.hpp>

#include "host/operator/page/server.h"
#include "host/output/datagrams/osc_reader.h"

namespace mixrig::page {

struct Hub;

/// A UDP port. The last eight senders of a readable message get the state, and each change of it,
/// at the address and port they send from. Beyond the loop-back address, and where the token has a
/// file, an OSC address must begin with "/TOKEN", the page's token if it has one; other messages
/// are dropped without an answer. Used on the server's thread.
class OscPort {
 public:
  explicit OscPort(Hub& hub);
  /// Opens the port. Errors: kIo where the port is taken or the address is not of this machine.
  Result<void> open(const Listen& listen);
  void tell(const nlohmann::json& state);
  std::uint16_t port() const { return port_; }
  /// Takes the page's token, which has changed.
  void renew_prefix();
  /// Prefix of OSC addresses: "" or "/TOKEN".
  const std::string& prefix() const { return prefix_; }

 private:
  using Endpoint = boost::asio::ip::udp::endpoint;
  struct Surface {
    Endpoint at;
    std::map<std::string, std::string> told;  ///< datagrams by address
  };
  void receive();
  void take(std::size_t bytes);
  bool strip_prefix(std::string& address) const;
  Surface& surface(const Endpoint& at);
  void act(stream::OscReceived message, const Endpoint& from);
  void send(const Endpoint& to, const std::string& datagram);
  void tell(Surface& surface, const std::map<std::string, std::string>& now);

  Hub& hub_;
  boost::asio::ip::udp::socket socket_;
  std::uint16_t port_ = 0;
  bool has_prefix_ = false;
  std::string prefix_;
  std::array<std::uint8_t, 4096> buffer_{};
  Endpoint from_;
  std::deque<Surface> surfaces_;
};

}  // namespace mixrig::page

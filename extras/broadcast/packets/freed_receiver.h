// SPDX-License-Identifier: Apache-2.0
// Receives FreeD packets from a camera head or a lens encoder at a port of this machine.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "extras/broadcast/packets/freed.h"
#include "extras/broadcast/packets/udp_receiver.h"
#include "hal/base/clock.h"
#include "hal/base/result.h"

namespace mixrig::stream {

/// Parses "freed:[HOST:]PORT[,CAMERA]", CAMERA 0..255. Without HOST the loop-back address is used.
/// Pure. Errors: kUsage.
Result<ListenAddress> parse_freed_address(const std::string& uri);

/// Follows the camera of its address; without a number the one of the first packet, and warns once
/// where others come. Warns once of packets that cannot be read. Not thread-safe. Nothing allocates
/// after open() but those warnings.
class FreeDReceiver {
 public:
  /// Opens the port; port 0 takes a free one. Errors: kUsage for an address that is not IPv4,
  /// kDevice where the port cannot be opened.
  static Result<FreeDReceiver> open(const ListenAddress& address);

  /// Waits for one datagram, `timeout` at most; nullopt where none came, or it was malformed or of
  /// another camera. Errors: kDevice where the socket fails.
  Result<std::optional<FreeDPacket>> next(Duration timeout);
  const StreamCounts& counts() const { return counts_; }
  int port() const { return socket_.port(); }

 private:
  FreeDReceiver(UdpReceiver socket, std::optional<int> camera)
      : socket_(std::move(socket)), camera_(camera), stated_(camera.has_value()) {}

  UdpReceiver socket_;
  std::optional<int> camera_;
  bool stated_;  ///< the address names the camera
  StreamCounts counts_;
};

}  // namespace mixrig::stream

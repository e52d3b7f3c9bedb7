// SPDX-License-Identifier: Apache-2.0
// FreeD packets as a head or a lens encoder sends them to a port of this machine.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "host/stream/freed.h"
#include "host/stream/udp_receiver.h"

namespace mixrig::stream {

struct FreeDAddress {
  std::string host = "127.0.0.1";  ///< address of this machine to listen on, IPv4; 0.0.0.0: all
  int port = 0;                    ///< there is no standard one
  std::optional<int> camera;       ///< packets of others are left out
};

/// "freed:[HOST:]PORT[,CAMERA]", CAMERA 0..255. Without HOST only this machine is listened to.
/// Pure. Errors: kUsage.
Result<FreeDAddress> parse_freed_address(const std::string& uri);

struct FreeDCounts {
  long packets = 0;
  long malformed = 0;  ///< datagrams that are no D1 packet, or damaged
  long foreign = 0;    ///< packets of another camera
};

/// Not thread-safe. Nothing allocates after open().
class FreeDReceiver {
 public:
  /// Port 0 takes a free one. Errors: kUsage for an address that is no IPv4, kDevice where the port
  /// cannot be opened.
  static Result<FreeDReceiver> open(const FreeDAddress& address);

  /// Waits for one datagram, `timeout` at most; nullopt where none came or it was not of the
  /// camera. Errors: kDevice where the socket fails.
  Result<std::optional<FreeDPacket>> next(Duration timeout);
  const FreeDCounts& counts() const { return counts_; }
  int port() const { return socket_.port(); }

 private:
  FreeDReceiver(UdpReceiver socket, std::optional<int> camera)
      : socket_(std::move(socket)), camera_(camera) {}

  UdpReceiver socket_;
  std::optional<int> camera_;
  FreeDCounts counts_;
};

}  // namespace mixrig::stream

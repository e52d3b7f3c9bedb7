// SPDX-License-Identifier: Apache-2.0
// Receives FreeD packets from a camera head or a lens encoder at a port of this machine.
#pragma once

#include <optional>
#include <string>

#include "extras/broadcast/packets/followed_sender.h"
#include "extras/broadcast/packets/freed.h"
#include "extras/broadcast/packets/udp_receiver.h"
#include "hal/base/clock.h"
#include "hal/base/result.h"

namespace mixrig::stream {

/// Parses "freed:[HOST:]PORT[,CAMERA][@SENDER]", CAMERA 0..255. Without HOST the loop-back address
/// is used. Pure. Errors: kUsage.
Result<ListenAddress> parse_freed_address(const std::string& uri);

/// Follows one camera (FollowedSender). Warns once of packets that cannot be read. Not thread-safe.
/// Nothing allocates after open() but warnings.
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
  FreeDReceiver(UdpReceiver socket, const ListenAddress& address)
      : socket_(std::move(socket)), followed_("FreeD", "cameras", address) {}

  UdpReceiver socket_;
  FollowedSender followed_;
  StreamCounts counts_;
};

}  // namespace mixrig::stream

// SPDX-License-Identifier: Apache-2.0
// OpenTrackIO samples as a tracker sends them to a port of this machine, or to a group.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "extras/broadcast/packets/opentrackio_assembler.h"
#include "extras/broadcast/packets/udp_receiver.h"
#include "hal/base/clock.h"
#include "hal/base/result.h"

namespace mixrig::stream {

inline constexpr int kOpenTrackPort = 55555;

/// "opentrackio:[HOST:]PORT[,SOURCE]", SOURCE 1..200; HOST an address of this machine, or of a
/// group, which is 239.135.1.SOURCE by the standard. Without HOST only this machine is listened to.
/// Pure. Errors: kUsage.
Result<ListenAddress> parse_opentrack_address(const std::string& uri);

/// Without a SOURCE that of the first sample is read. Not thread-safe.
class OpenTrackReceiver {
 public:
  /// Port 0 takes a free one. Errors: of UdpReceiver::open().
  static Result<OpenTrackReceiver> open(const ListenAddress& address);
  /// Waits for one datagram, `timeout` at most; nullopt where none came or no sample became whole.
  /// Errors: kDevice where the socket fails.
  Result<std::optional<OpenTrackReading>> next(Duration timeout);
  StreamCounts counts() const;
  int port() const { return socket_.port(); }

 private:
  OpenTrackReceiver(UdpReceiver socket, std::optional<int> source)
      : socket_(std::move(socket)), source_(source) {}
  std::optional<OpenTrackReading> take(std::span<const std::byte> datagram);

  UdpReceiver socket_;
  std::optional<int> source_;
  OpenTrackAssembler assembler_;
  StreamCounts counts_;
  std::array<std::byte, 65536> buffer_;
};

}  // namespace mixrig::stream

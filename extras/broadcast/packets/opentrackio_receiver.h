// SPDX-License-Identifier: Apache-2.0
// Receives OpenTrackIO samples of a tracker at a port of this machine, or from a multicast group.
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

/// Parses "opentrackio:[HOST:]PORT[,SOURCE]", SOURCE 1..200. HOST is an address of this machine, or
/// of a multicast group, which is 239.135.1.SOURCE by the standard. Without HOST the loop-back
/// address is used. Pure. Errors: kUsage.
Result<ListenAddress> parse_opentrack_address(const std::string& uri);

/// Receives the samples of one source: SOURCE, or without it the source of the first sample. Not
/// thread-safe.
class OpenTrackReceiver {
 public:
  /// Opens the port; port 0 takes a free one. Errors: those of UdpReceiver::open().
  static Result<OpenTrackReceiver> open(const ListenAddress& address);
  /// Waits for one datagram, `timeout` at most; nullopt where none came or it completed no sample.
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

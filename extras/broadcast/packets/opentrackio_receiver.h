// SPDX-License-Identifier: Apache-2.0
// Receives OpenTrackIO samples of a tracker at a port of this machine, or from a multicast group.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "extras/broadcast/packets/followed_sender.h"
#include "extras/broadcast/packets/opentrackio_assembler.h"
#include "extras/broadcast/packets/udp_receiver.h"
#include "hal/base/clock.h"
#include "hal/base/result.h"

namespace mixrig::stream {

inline constexpr int kOpenTrackPort = 55555;

/// Parses "opentrackio:[HOST:]PORT[,SOURCE][@SENDER]", SOURCE 1..200. HOST is an address of this
/// machine, or of a multicast group, which is 239.135.1.SOURCE by the standard. Without HOST the
/// loop-back address is used. Pure. Errors: kUsage.
Result<ListenAddress> parse_opentrack_address(const std::string& uri);

/// Receives the samples of one source (FollowedSender), whatever others send. Warns once of samples
/// that cannot be read. Not thread-safe.
class OpenTrackReceiver {
 public:
  /// Opens the port; port 0 takes a free one. Errors: those of UdpReceiver::open().
  static Result<OpenTrackReceiver> open(const ListenAddress& address);
  /// Waits for one datagram, `timeout` at most; nullopt where none came or it completed no sample.
  /// Errors: kDevice where the socket fails.
  Result<std::optional<OpenTrackReading>> next(Duration timeout);
  const StreamCounts& counts() const { return counts_; }
  int port() const { return socket_.port(); }

 private:
  OpenTrackReceiver(UdpReceiver socket, const ListenAddress& address)
      : socket_(std::move(socket)),
        followed_("OpenTrackIO", "sources", address),
        buffer_(kLongest) {}
  static constexpr std::size_t kLongest = 65536;
  std::optional<OpenTrackReading> take(const Datagram& datagram);
  void leave_out(const Error& why);
  /// Whether a sample comes after those before; counts late and lost ones.
  bool is_next(std::uint16_t sequence);

  UdpReceiver socket_;
  FollowedSender followed_;
  OpenTrackAssembler assembler_;
  std::optional<std::uint16_t> sequence_;  ///< of the last sample of the source
  StreamCounts counts_;
  std::vector<std::byte> buffer_;
};

}  // namespace mixrig::stream

// SPDX-License-Identifier: Apache-2.0
// Datagrams that come to a port of this machine, or to a multicast group.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "hal/base/clock.h"
#include "hal/base/result.h"

namespace mixrig::stream {

/// Not thread-safe. Nothing allocates after open().
class UdpReceiver {
 public:
  /// `host`: IPv4 address of this machine to listen on, 0.0.0.0 for all, or a multicast group,
  /// which is joined. Port 0 takes a free one. `protocol` begins the errors: kUsage for an address
  /// that is no IPv4, kDevice where the port cannot be opened.
  static Result<UdpReceiver> open(std::string protocol, const std::string& host, int port);
  UdpReceiver(UdpReceiver&& other) noexcept;
  UdpReceiver& operator=(UdpReceiver&& other) noexcept;
  ~UdpReceiver();

  /// Waits for one datagram, `timeout` at most, and gives its bytes in `buffer`; a longer one is
  /// cut. nullopt where none came. Errors: kDevice where the socket fails.
  Result<std::optional<std::span<const std::byte>>> next(std::span<std::byte> buffer,
                                                         Duration timeout);
  int port() const { return port_; }

 private:
  UdpReceiver(std::string protocol, int fd, int port)
      : protocol_(std::move(protocol)), fd_(fd), port_(port) {}

  std::string protocol_;
  int fd_ = -1, port_ = 0;
};

/// "[HOST:]PORT[,NUMBER]" after a scheme; a HOST that is missing stays as it was.
struct ListenAddress {
  std::string host = "127.0.0.1";  ///< IPv4 of this machine, 0.0.0.0 for all, or of a group
  int port = 0;
  std::optional<int> number;
};
/// How a protocol's addresses are written: "SCHEME:[HOST:]PORT[,NUMBER]".
struct ListenScheme {
  const char *scheme, *protocol, *number;  ///< "freed", "FreeD", "CAMERA"
  int least_number, most_number;
};
/// Errors: kUsage for another text, a port of 0 or above 65535, a number outside the range. Pure.
Result<ListenAddress> parse_listen_uri(const std::string& uri, const ListenScheme& scheme);

/// What became of the datagrams of a stream.
struct StreamCounts {
  long packets = 0;         ///< that were read: of OpenTrackIO whole samples
  long lost = 0, late = 0;  ///< by their numbers; FreeD has none
  long malformed = 0;       ///< none of the protocol, or damaged
  long foreign = 0;         ///< of another camera or source
};

}  // namespace mixrig::stream

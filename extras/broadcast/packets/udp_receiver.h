// SPDX-License-Identifier: Apache-2.0
// Receives datagrams at a port of this machine, or from a multicast group.
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
  /// Opens the port. `host`: IPv4 address of this machine to listen on, 0.0.0.0 for all, or a
  /// multicast group, which is joined. Port 0 takes a free one. Errors begin with `protocol`:
  /// kUsage for an address that is not IPv4, kDevice where the port cannot be opened.
  static Result<UdpReceiver> open(std::string protocol, const std::string& host, int port);
  UdpReceiver(UdpReceiver&& other) noexcept;
  UdpReceiver& operator=(UdpReceiver&& other) noexcept;
  ~UdpReceiver();

  /// Waits for one datagram, `timeout` at most, and returns its bytes in `buffer`; a longer one is
  /// cut off. nullopt where none came. Errors: kDevice where the socket fails.
  Result<std::optional<std::span<const std::byte>>> next(std::span<std::byte> buffer,
                                                         Duration timeout);
  int port() const { return port_; }

 private:
  UdpReceiver(std::string protocol, int fd, int port)
      : protocol_(std::move(protocol)), fd_(fd), port_(port) {}

  std::string protocol_;
  int fd_ = -1, port_ = 0;
};

/// Parts of "[HOST:]PORT[,NUMBER]" after a scheme; a missing HOST keeps the default.
struct ListenAddress {
  std::string host = "127.0.0.1";  ///< IPv4 of this machine, 0.0.0.0 for all, or of a group
  int port = 0;
  std::optional<int> number;
};
/// Form of a protocol's addresses: "SCHEME:[HOST:]PORT[,NUMBER]".
struct ListenScheme {
  const char *scheme, *protocol, *number;  ///< "freed", "FreeD", "CAMERA"
  int least_number, most_number;
};
/// Parses an address. Errors: kUsage for another text, a port of 0 or above 65535, a number outside
/// the range. Pure.
Result<ListenAddress> parse_listen_uri(const std::string& uri, const ListenScheme& scheme);

/// Counts of a stream's datagrams.
struct StreamCounts {
  long packets = 0;         ///< packets read; for OpenTrackIO whole samples
  long lost = 0, late = 0;  ///< by sequence numbers, which FreeD lacks
  long malformed = 0;       ///< datagrams of another protocol, or damaged ones
  long foreign = 0;         ///< packets of another camera or source
};

}  // namespace mixrig::stream

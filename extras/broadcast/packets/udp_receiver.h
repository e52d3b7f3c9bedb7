// SPDX-License-Identifier: Apache-2.0
// Receives datagrams at a port of this machine, or from a multicast group.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "hal/base/clock.h"
#include "hal/base/result.h"

namespace mixrig::stream {

/// IPv4 address and port of a program that sends, in the host's byte order.
struct Sender {
  std::uint32_t address = 0;
  std::uint16_t port = 0;
};
/// "192.168.1.20".
std::string address_text(std::uint32_t address);

struct Datagram {
  std::span<const std::byte> bytes;
  Sender from;
};

class UdpPort;

/// Several receivers of this process may listen at one address and port: each gets every datagram,
/// in order. One receiver is not thread-safe; two may be used in two threads. Nothing allocates
/// after open().
class UdpReceiver {
 public:
  /// Opens the port, or shares it. `host`: IPv4 address of this machine to listen on, 0.0.0.0 for
  /// all, or a multicast group, which is joined. Port 0 takes a free one. Errors begin with
  /// `protocol`: kUsage for an address that is not IPv4, kDevice where the port cannot be opened.
  static Result<UdpReceiver> open(std::string protocol, const std::string& host, int port);
  UdpReceiver(UdpReceiver&& other) noexcept;
  UdpReceiver& operator=(UdpReceiver&& other) noexcept;
  ~UdpReceiver();

  /// Waits for one datagram, `timeout` at most, and returns its bytes in `buffer`; a longer one is
  /// cut off. nullopt where none came. Errors: kDevice where the socket fails.
  Result<std::optional<Datagram>> next(std::span<std::byte> buffer, Duration timeout);
  int port() const;

 private:
  UdpReceiver(std::string protocol, std::shared_ptr<UdpPort> port, int inbox)
      : protocol_(std::move(protocol)), port_(std::move(port)), inbox_(inbox) {}

  std::string protocol_;
  std::shared_ptr<UdpPort> port_;
  int inbox_ = -1;  ///< datagrams of the port for this receiver
};

/// Parts of "[HOST:]PORT[,NUMBER][@SENDER]" after a scheme; a missing HOST keeps the default.
struct ListenAddress {
  std::string host = "127.0.0.1";  ///< IPv4 of this machine, 0.0.0.0 for all, or of a group
  int port = 0;
  std::optional<int> number = {};
  std::optional<std::uint32_t> sender = {};  ///< IPv4 of the only machine that is heard
};
/// Form of a protocol's addresses: "SCHEME:[HOST:]PORT[,NUMBER][@SENDER]".
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
  long other_version = 0;   ///< packets of a version of the protocol that is not read
  long foreign = 0;         ///< packets of another camera, source or sender
};

}  // namespace mixrig::stream

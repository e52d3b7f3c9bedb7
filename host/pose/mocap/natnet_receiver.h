// SPDX-License-Identifier: Apache-2.0
// NatNet frames as a server sends them: to us (unicast), or to a group (multicast).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <netinet/in.h>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "host/pose/mocap/natnet.h"

namespace mixrig::stream {

/// Where a server is. Ports are Motive's.
struct NatNetAddress {
  std::string host = "127.0.0.1";  ///< IPv4 or a name
  std::string group;               ///< of multicast, such as 239.255.42.99; empty: unicast
  int command_port = 1510, data_port = 1511;
};

/// "natnet[:HOST[:PORT]][,GROUP[:PORT]]": the port of commands, and of the group's data. Pure.
/// Errors: kUsage.
Result<NatNetAddress> parse_natnet_address(const std::string& uri);

/// Counts of datagrams. A frame is lost where numbers jump, late where they do not increase.
/// Numbers that go on from an earlier one, or that jump by more than a server can send in that
/// time, are those of a server that restarted: nothing is lost.
struct NatNetCounts {
  long frames = 0, lost = 0, late = 0;
  long malformed = 0;  ///< datagrams that are no packet of NatNet
  long foreign = 0;  ///< datagrams from another machine, frames of a second server on the same one
};

/// Requests the stream from the server once a second, as servers require, and reads its datagrams.
/// Datagrams from other addresses are ignored. Not thread-safe.
class NatNetReceiver {
 public:
  /// `version` is used until the server sends its own. Errors: kNotFound for an unknown host name,
  /// kDevice where no socket can be opened.
  static Result<NatNetReceiver> open(const NatNetAddress& address, NatNetVersion version,
                                     const Clock& clock);

  /// Waits for one datagram, `timeout` at most; nullopt where none came or it was no frame.
  /// Errors: kDevice where a socket fails; kUnsupported for a server below 3.0.
  Result<std::optional<NatNetFrame>> next(Duration timeout);
  const NatNetCounts& counts() const { return counts_; }

 private:
  class Socket {  // closed with the object
   public:
    explicit Socket(int fd) : fd_(fd) {}
    Socket(Socket&& other) noexcept;
    Socket& operator=(Socket&& other) noexcept;
    ~Socket();
    int fd() const { return fd_; }

   private:
    int fd_;
  };

  NatNetReceiver(sockaddr_in server, std::vector<Socket> sockets, NatNetVersion version,
                 const Clock& clock);
  static Result<Socket> open_command(const sockaddr_in& server);
  static Result<Socket> open_group(const NatNetAddress& address, const sockaddr_in& server);
  void request_stream();
  Result<std::optional<NatNetFrame>> read(int fd);
  Result<std::optional<NatNetFrame>> take(const NatNetPacket& packet, int port);
  bool is_of_our_server(int port, HostTime now);
  bool is_next(int number, HostTime now);
  bool goes_on_from_before(int number);

  sockaddr_in server_;
  std::vector<Socket> sockets_;  ///< of commands, then of the group
  NatNetVersion version_;
  const Clock* clock_;
  std::optional<HostTime> requested_;
  std::optional<int> last_number_;
  HostTime last_frame_{};           ///< arrival
  std::optional<int> frame_port_;   ///< the port that frames come from
  std::optional<int> back_number_;  ///< of the last frame whose number went back
  int back_run_ = 0;                ///< such frames in a row, each number above the one before
  std::vector<std::byte> buffer_;
  NatNetCounts counts_;
};

}  // namespace mixrig::stream

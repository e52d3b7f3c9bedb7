// SPDX-License-Identifier: Apache-2.0
// Receives NatNet frames from a server: unicast, or multicast to a group.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <netinet/in.h>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "host/pose/mocap/natnet.h"

namespace mixrig::stream {

/// Address of a server. The default ports are Motive's.
struct NatNetAddress {
  std::string host = "127.0.0.1";  ///< IPv4 or a name
  std::string group;               ///< multicast group, such as 239.255.42.99; empty: unicast
  int command_port = 1510, data_port = 1511;
};

/// Parses "natnet[:HOST[:PORT]][,GROUP[:PORT]]": the port of commands, and that of the group's
/// data. Pure. Errors: kUsage.
Result<NatNetAddress> parse_natnet_address(const std::string& uri);

/// Counts of datagrams. A frame is lost if numbers jump, late if they do not increase. If numbers
/// go far back, or go back and then rise for several frames, or jump by more than a server can send
/// in that time, the server has restarted, and nothing counts as lost.
struct NatNetCounts {
  long frames = 0, lost = 0, late = 0;
  long malformed = 0;  ///< datagrams that are no NatNet packet
  long foreign = 0;  ///< datagrams from another machine, frames of a second server on the same one
};

/// Requests the stream from the server once a second, as servers require, and reads its datagrams.
/// Datagrams from other addresses are ignored. Warns once of packets that cannot be read. Not
/// thread-safe.
class NatNetReceiver {
 public:
  /// `version` is used until the server sends its own. Errors: kNotFound for an unknown host name,
  /// kDevice where no socket can be opened.
  static Result<NatNetReceiver> open(const NatNetAddress& address, NatNetVersion version,
                                     const Clock& clock);

  /// Waits for one datagram, at most `timeout`; nullopt if none came or it was no frame. Errors:
  /// kDevice if a socket fails; kUnsupported for a server below 3.0.
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
  void leave_out(const Error& why);
  Result<std::optional<NatNetFrame>> take(const NatNetPacket& packet, int port);
  bool is_of_our_server(int port, HostTime now);
  bool is_next(int number, HostTime now);
  bool goes_on_from_before(int number);

  sockaddr_in server_;
  std::vector<Socket> sockets_;  ///< for commands, then for the group
  NatNetVersion version_;
  const Clock* clock_;
  std::optional<HostTime> requested_;
  std::optional<int> last_number_;
  HostTime last_frame_{};           ///< arrival of the last frame
  std::optional<int> frame_port_;   ///< the port that frames come from
  std::optional<int> back_number_;  ///< number of the last frame whose number went back
  int back_run_ = 0;                ///< number of such frames in a row with rising numbers
  std::vector<std::byte> buffer_;
  NatNetCounts counts_;
};

}  // namespace mixrig::stream

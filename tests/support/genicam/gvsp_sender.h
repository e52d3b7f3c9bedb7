// SPDX-License-Identifier: Apache-2.0
// Sends the stream of a GigE Vision camera: packets as GVSP 2.0 lays them out (leader, data,
// trailer), pictures with or without chunks, and multi-part payload.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <netinet/in.h>

#include "hal/base/image.h"

namespace mixrig::test {

/// A picture of one pixel format (PFNC code).
struct GvspPicture {
  std::uint32_t code = 0;
  Size size{};
  std::span<const std::uint8_t> bytes{};
  std::uint16_t data_type = 1;  ///< of a part: 1 picture, 5 3D picture, 9 confidence
  std::uint16_t purpose = 0;    ///< of a part: the component
};

/// Destination of the stream, as set in the camera's registers.
struct GvspHost {
  std::uint32_t address = 0;  ///< IPv4
  std::uint16_t port = 0;
  std::size_t packet_bytes = 0;  ///< including the headers of IP, UDP and GVSP
};

/// Sends packets from one thread. Waits while the receiver's socket on this machine is full, so
/// that no packet is lost on the loopback interface however slow the receiver is.
class GvspSender {
 public:
  GvspSender();
  ~GvspSender();
  GvspSender(const GvspSender&) = delete;
  GvspSender& operator=(const GvspSender&) = delete;

  /// Sends one picture. `id` counts from 1 and has 16 bits; `chunks` are appended to the picture's
  /// bytes.
  void send_picture(const GvspHost& host, std::uint16_t id, std::uint64_t stamp_ns,
                    const GvspPicture& picture, std::span<const std::uint8_t> chunks = {});
  /// Sends all parts in one block with a 64-bit id, as multi-part payload requires.
  void send_parts(const GvspHost& host, std::uint64_t id, std::uint64_t stamp_ns,
                  std::span<const GvspPicture> parts);

 private:
  void send(const GvspHost& host, const std::vector<std::uint8_t>& packet);
  int socket_;
  std::size_t unread_bytes_ = 0;  ///< sent since the receiver's queue was last read
};

}  // namespace mixrig::test

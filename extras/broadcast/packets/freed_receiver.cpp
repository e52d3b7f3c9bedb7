// SPDX-License-Identifier: Apache-2.0
#include "extras/broadcast/packets/freed_receiver.h"

#include <fmt/format.h>

#include "hal/base/log.h"

namespace mixrig::stream {

Result<ListenAddress> parse_freed_address(const std::string& uri) {
  return parse_listen_uri(uri, {"freed", "FreeD", "CAMERA", 0, 255});
}

Result<FreeDReceiver> FreeDReceiver::open(const ListenAddress& address) {
  MIXRIG_ASSIGN(auto socket, UdpReceiver::open("FreeD", address.host, address.port));
  return FreeDReceiver(std::move(socket), address.number);
}

Result<std::optional<FreeDPacket>> FreeDReceiver::next(Duration timeout) {
  std::array<std::byte, kFreeDBytes + 1> buffer;  // one more tells a longer datagram
  MIXRIG_ASSIGN(const auto bytes, socket_.next(buffer, timeout));
  if (!bytes) return std::optional<FreeDPacket>();
  const auto packet = parse_freed(*bytes);
  if (!packet) {
    if (counts_.malformed++ == 0)
      log_warning("stream", fmt::format("{} (port {}): such packets are left out",
                                        packet.error().context, port()));
    return std::optional<FreeDPacket>();
  }
  if (!camera_) camera_ = packet->camera;
  if (packet->camera != *camera_) {
    if (counts_.foreign++ == 0 && !stated_)
      log_warning("stream",
                  fmt::format("FreeD: cameras {} and {} send to port {}: {} came first and is "
                              "followed; name one, like {},{}",
                              *camera_, packet->camera, port(), *camera_, port(), *camera_));
    return std::optional<FreeDPacket>();
  }
  ++counts_.packets;
  return std::optional(*packet);
}

}  // namespace mixrig::stream

// SPDX-License-Identifier: Apache-2.0
#include "extras/broadcast/packets/freed_receiver.h"

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
    ++counts_.malformed;
    return std::optional<FreeDPacket>();
  }
  if (camera_ && packet->camera != *camera_) {
    ++counts_.foreign;
    return std::optional<FreeDPacket>();
  }
  ++counts_.packets;
  return std::optional(*packet);
}

}  // namespace mixrig::stream

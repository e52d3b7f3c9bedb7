// SPDX-License-Identifier: Apache-2.0
#include "host/stream/freed_receiver.h"

namespace mixrig::stream {

Result<FreeDAddress> parse_freed_address(const std::string& uri) {
  constexpr std::string_view kScheme = "freed:";
  const auto listen =
      uri.starts_with(kScheme)
          ? parse_listen_address(std::string_view(uri).substr(kScheme.size()), 0, 255)
          : std::nullopt;
  if (!listen)
    return Error{ErrorCode::kUsage,
                 "\"" + uri + "\" is no address of FreeD: use freed:[HOST:]PORT[,CAMERA]"};
  return FreeDAddress{listen->host, listen->port, listen->number};
}

Result<FreeDReceiver> FreeDReceiver::open(const FreeDAddress& address) {
  MIXRIG_ASSIGN(auto socket, UdpReceiver::open("FreeD", address.host, address.port));
  return FreeDReceiver(std::move(socket), address.camera);
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

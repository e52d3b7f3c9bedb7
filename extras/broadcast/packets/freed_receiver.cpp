// SPDX-License-Identifier: Apache-2.0
#include "extras/broadcast/packets/freed_receiver.h"

#include <array>

#include <fmt/format.h>

#include "hal/base/log.h"

namespace mixrig::stream {

Result<ListenAddress> parse_freed_address(const std::string& uri) {
  return parse_listen_uri(uri, {"freed", "FreeD", "CAMERA", 0, 255});
}

Result<FreeDReceiver> FreeDReceiver::open(const ListenAddress& address) {
  MIXRIG_ASSIGN(auto socket, UdpReceiver::open("FreeD", address.host, address.port));
  return FreeDReceiver(std::move(socket), address);
}

Result<std::optional<FreeDPacket>> FreeDReceiver::next(Duration timeout) {
  std::array<std::byte, kFreeDBytes + 1> buffer;  // one more tells a longer datagram
  MIXRIG_ASSIGN(const auto datagram, socket_.next(buffer, timeout));
  if (!datagram) return std::optional<FreeDPacket>();
  const auto packet = parse_freed(datagram->bytes);
  if (!packet) {
    if (counts_.malformed++ == 0)
      log_warning("stream", fmt::format("{} (port {}): such packets are left out",
                                        packet.error().context, port()));
    return std::optional<FreeDPacket>();
  }
  if (!followed_.takes(packet->camera, datagram->from.address, port())) {
    ++counts_.foreign;
    return std::optional<FreeDPacket>();
  }
  ++counts_.packets;
  return std::optional(*packet);
}

}  // namespace mixrig::stream

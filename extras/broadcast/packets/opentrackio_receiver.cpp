// SPDX-License-Identifier: Apache-2.0
#include "extras/broadcast/packets/opentrackio_receiver.h"

namespace mixrig::stream {

Result<ListenAddress> parse_opentrack_address(const std::string& uri) {
  return parse_listen_uri(uri, {"opentrackio", "OpenTrackIO", "SOURCE", 1, 200});
}

Result<OpenTrackReceiver> OpenTrackReceiver::open(const ListenAddress& address) {
  MIXRIG_ASSIGN(auto socket, UdpReceiver::open("OpenTrackIO", address.host, address.port));
  return OpenTrackReceiver(std::move(socket), address.number);
}

Result<std::optional<OpenTrackReading>> OpenTrackReceiver::next(Duration timeout) {
  MIXRIG_ASSIGN(const auto datagram, socket_.next(buffer_, timeout));
  return datagram ? take(*datagram) : std::optional<OpenTrackReading>();
}

std::optional<OpenTrackReading> OpenTrackReceiver::take(std::span<const std::byte> datagram) {
  const auto segment = parse_opentrack_datagram(datagram);
  if (!segment) {
    ++counts_.malformed;
    return std::nullopt;
  }
  const auto payload = assembler_.add(*segment);
  if (!payload) return std::nullopt;
  auto reading = parse_opentrack_payload(payload->bytes, payload->encoding);
  if (!reading) {
    ++counts_.malformed;
    return std::nullopt;
  }
  if (!source_) source_ = reading->source;
  if (reading->source != *source_) {
    ++counts_.foreign;
    return std::nullopt;
  }
  ++counts_.packets;
  return *std::move(reading);
}

StreamCounts OpenTrackReceiver::counts() const {
  StreamCounts counts = counts_;
  counts.lost = assembler_.lost();
  counts.late = assembler_.late();
  return counts;
}

}  // namespace mixrig::stream

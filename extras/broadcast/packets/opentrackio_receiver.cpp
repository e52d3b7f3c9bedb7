// SPDX-License-Identifier: Apache-2.0
#include "extras/broadcast/packets/opentrackio_receiver.h"

#include <fmt/format.h>

#include "hal/base/log.h"

namespace mixrig::stream {
namespace {

constexpr int kLateWithin = 16;     // samples: a number farther back is of a sender that restarted
constexpr int kLostWithin = 0x800;  // farther ahead too

}  // namespace

Result<ListenAddress> parse_opentrack_address(const std::string& uri) {
  return parse_listen_uri(uri, {"opentrackio", "OpenTrackIO", "SOURCE", 1, 200});
}

Result<OpenTrackReceiver> OpenTrackReceiver::open(const ListenAddress& address) {
  MIXRIG_ASSIGN(auto socket, UdpReceiver::open("OpenTrackIO", address.host, address.port));
  return OpenTrackReceiver(std::move(socket), address);
}

Result<std::optional<OpenTrackReading>> OpenTrackReceiver::next(Duration timeout) {
  MIXRIG_ASSIGN(const auto datagram, socket_.next(buffer_, timeout));
  return datagram ? take(*datagram) : std::optional<OpenTrackReading>();
}

std::optional<OpenTrackReading> OpenTrackReceiver::take(const Datagram& datagram) {
  const auto segment = parse_opentrack_datagram(datagram.bytes);
  if (!segment) {
    leave_out(segment.error());
    return std::nullopt;
  }
  const auto payload = assembler_.add(*segment, datagram.from);
  if (!payload) return std::nullopt;
  auto reading = parse_opentrack_payload(payload->bytes, payload->encoding);
  if (!reading) {
    leave_out(reading.error());
    return std::nullopt;
  }
  if (!followed_.takes(reading->source, datagram.from.address, port())) {
    ++counts_.foreign;
    return std::nullopt;
  }
  if (!is_next(segment->sequence)) return std::nullopt;
  ++counts_.packets;
  return *std::move(reading);
}

void OpenTrackReceiver::leave_out(const Error& why) {
  long& count = why.code == ErrorCode::kUnsupported ? counts_.other_version : counts_.malformed;
  if (count++ == 0)
    log_warning("stream",
                fmt::format("{} (port {}): such packets are left out", why.context, port()));
}

bool OpenTrackReceiver::is_next(std::uint16_t sequence) {
  if (sequence_) {
    const int step = static_cast<std::int16_t>(static_cast<std::uint16_t>(sequence - *sequence_));
    if (step <= 0 && step >= -kLateWithin) return ++counts_.late, false;
    if (step > 0 && step < kLostWithin) counts_.lost += step - 1;
  }
  sequence_ = sequence;
  return true;
}

}  // namespace mixrig::stream

// SPDX-License-Identifier: Apache-2.0
#include "extras/broadcast/packets/opentrackio.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "extras/broadcast/packets/opentrackio_bytes.h"
#include "hal/base/angles.h"

namespace mixrig::stream {
namespace {

using nlohmann::json;
using namespace opentrack_bytes;

constexpr std::int64_t kNs = 1'000'000'000;

std::string urn_of(const Uuid& id) {
  std::string text = "urn:uuid:";
  for (std::size_t i = 0; i < id.size(); ++i) {
    if (i == 4 || i == 6 || i == 8 || i == 10) text += '-';
    text += fmt::format("{:02x}", id[i]);
  }
  return text;
}

json to_json(const OpenTrackSample& s) {
  json out{
      {"protocol", {{"name", "OpenTrackIO"}, {"version", {1, 0, 1}}}},
      {"sampleId", urn_of(s.sample_id)},
      {"sourceId", urn_of(s.source_id)},
      {"sourceNumber", s.source},
      {"timing",
       {{"mode", "internal"},
        {"sequenceNumber", s.number},
        {"sampleTimestamp", {{"seconds", s.time_ns / kNs}, {"nanoseconds", s.time_ns % kNs}}}}}};
  if (s.synchronization) {
    using Source = OpenTrackSample::Synchronization::Source;
    out["timing"]["synchronization"] = {
        {"locked", s.synchronization->locked},
        {"source", s.synchronization->source == Source::kPtp ? "ptp" : "ntp"}};
  }
  if (!s.status.empty()) out["tracker"]["status"] = s.status;
  if (s.focal_length_mm > 0) {
    out["lens"]["pinholeFocalLength"] = s.focal_length_mm;
    out["lens"]["projectionOffset"] = {{"x", s.offset_mm.x()}, {"y", s.offset_mm.y()}};
  }
  if (s.zoom) out["lens"]["rawEncoders"]["zoom"] = std::llround(*s.zoom);
  if (s.focus) out["lens"]["rawEncoders"]["focus"] = std::llround(*s.focus);
  if (s.sensor)
    out["static"]["camera"] = {{"activeSensorPhysicalDimensions",
                                {{"width", s.sensor->width_mm}, {"height", s.sensor->height_mm}}},
                               {"activeSensorResolution",
                                {{"width", s.sensor->width_px}, {"height", s.sensor->height_px}}}};
  if (s.angles)
    out["transforms"] = {
        {{"id", "Camera"},
         {"translation",
          {{"x", s.position_m.x()}, {"y", s.position_m.y()}, {"z", s.position_m.z()}}},
         {"rotation",
          {{"pan", s.angles->pan_rad / kDeg},
           {"tilt", s.angles->tilt_rad / kDeg},
           {"roll", s.angles->roll_rad / kDeg}}}}};
  return out;
}

}  // namespace

std::vector<std::byte> opentrack_payload(const OpenTrackSample& sample,
                                         OpenTrackEncoding encoding) {
  const json out = to_json(sample);
  std::vector<std::byte> bytes;
  if (encoding == OpenTrackEncoding::kCbor) {
    const std::vector<std::uint8_t> cbor = json::to_cbor(out);
    bytes.resize(cbor.size());
    std::transform(cbor.begin(), cbor.end(), bytes.begin(),
                   [](std::uint8_t b) { return std::byte{b}; });
    return bytes;
  }
  const std::string text = out.dump();
  bytes.resize(text.size());
  std::transform(text.begin(), text.end(), bytes.begin(),
                 [](char c) { return static_cast<std::byte>(c); });
  return bytes;
}

std::vector<std::byte> opentrack_datagram(const OpenTrackSegment& segment) {
  std::vector<std::byte> bytes(kOpenTrackHeaderBytes + segment.payload.size());
  std::transform(kMagic.begin(), kMagic.end(), bytes.begin(),
                 [](char c) { return static_cast<std::byte>(c); });
  put_big(static_cast<std::uint32_t>(segment.encoding), 1, &bytes[kEncodingAt]);
  put_big(segment.sequence, 2, &bytes[kSequenceAt]);
  put_big(segment.offset, 4, &bytes[kOffsetAt]);
  put_big((segment.last ? kLastBit : 0U) | static_cast<std::uint32_t>(segment.payload.size()), 2,
          &bytes[kLengthAt]);
  std::copy(segment.payload.begin(), segment.payload.end(), bytes.begin() + kOpenTrackHeaderBytes);
  put_big(fletcher16(bytes), 2, &bytes[kFletcherAt]);
  return bytes;
}

std::vector<std::vector<std::byte>> opentrack_datagrams(std::span<const std::byte> payload,
                                                        OpenTrackEncoding encoding,
                                                        std::uint16_t sequence) {
  std::vector<std::vector<std::byte>> datagrams;
  std::size_t at = 0;
  do {
    const std::size_t size = std::min(kOpenTrackPayloadBytes, payload.size() - at);
    datagrams.push_back(
        opentrack_datagram({encoding, sequence, static_cast<std::uint32_t>(at),
                            at + size == payload.size(), payload.subspan(at, size)}));
    at += size;
  } while (at < payload.size());
  return datagrams;
}

}  // namespace mixrig::stream

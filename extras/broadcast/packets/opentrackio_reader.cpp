// SPDX-License-Identifier: Apache-2.0
#include "extras/broadcast/packets/opentrackio_reader.h"

#include <cmath>
#include <cstring>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "extras/broadcast/packets/opentrackio_bytes.h"
#include "hal/base/angles.h"

namespace mixrig::stream {
namespace {

using nlohmann::json;

constexpr int kMostDeep = 32;
constexpr std::size_t kMostTransforms = 16;
constexpr double kMost_m = 1e6, kMost_deg = 1e6;
constexpr std::int64_t kMost_s = 1LL << 33;  // in ns it fits 64 bits

Error bad_sample(const std::string& what) { return {ErrorCode::kData, "OpenTrackIO: " + what}; }

/// Stops the parser where the text is nested too deep: the one of CBOR calls itself.
class DepthLimit final : public nlohmann::json_sax<json> {
 public:
  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool start_object(std::size_t) override { return ++depth_ <= kMostDeep; }
  bool key(string_t&) override { return true; }
  bool end_object() override { return --depth_, true; }
  bool start_array(std::size_t) override { return ++depth_ <= kMostDeep; }
  bool end_array() override { return --depth_, true; }
  bool parse_error(std::size_t, const std::string&, const json::exception&) override {
    return false;
  }

 private:
  int depth_ = 0;
};

/// Parses JSON or CBOR; a discarded value where the bytes are not valid or nested too deep.
json parse_bounded(std::span<const std::byte> bytes, OpenTrackEncoding encoding) {
  const auto* const begin = reinterpret_cast<const std::uint8_t*>(bytes.data());
  const auto* const end = begin + bytes.size();
  const bool cbor = encoding == OpenTrackEncoding::kCbor;
  DepthLimit limit;
  const auto format = cbor ? json::input_format_t::cbor : json::input_format_t::json;
  if (!json::sax_parse(begin, end, &limit, format)) return json(json::value_t::discarded);
  return cbor ? json::from_cbor(begin, end, true, false) : json::parse(begin, end, nullptr, false);
}

const json* member(const json& object, const char* key) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}

/// Numbers `keys` of the object `key` of `in`. Errors: kData.
Result<Eigen::Vector3d> three_numbers(const json& in, const char* key,
                                      const std::array<const char*, 3>& keys, double most) {
  const json* const object = member(in, key);
  Eigen::Vector3d values;
  for (std::size_t i = 0; i < 3; ++i) {
    const json* const value = object == nullptr ? nullptr : member(*object, keys[i]);
    if (value == nullptr || !value->is_number())
      return bad_sample(fmt::format("transforms.{}.{} is no number", key, keys[i]));
    const double number = value->get<double>();
    if (!(std::abs(number) <= most))
      return bad_sample(
          fmt::format("transforms.{}.{} = {} is out of bounds", key, keys[i], number));
    values[static_cast<Eigen::Index>(i)] = number;
  }
  return values;
}

Result<geometry::Pose> parse_transform(const json& transform) {
  if (member(transform, "scale") != nullptr) {
    MIXRIG_ASSIGN(const auto scale, three_numbers(transform, "scale", {"x", "y", "z"}, 1e9));
    if (scale != Eigen::Vector3d::Ones()) return bad_sample("a transform scales: send it unscaled");
  }
  MIXRIG_ASSIGN(const auto at_m, three_numbers(transform, "translation", {"x", "y", "z"}, kMost_m));
  MIXRIG_ASSIGN(const auto deg,
                three_numbers(transform, "rotation", {"pan", "tilt", "roll"}, kMost_deg));
  const Eigen::Quaterniond level_from_camera = world_from_camera({});
  const Eigen::Quaterniond turned =
      world_from_camera({deg.x() * kDeg, deg.y() * kDeg, deg.z() * kDeg});
  return geometry::Pose{turned * level_from_camera.conjugate(), at_m};
}

/// Each transform is in the frame of the one before, which is its parent where it names one.
Result<geometry::Pose> parse_transforms(const json& list) {
  if (!list.is_array() || list.empty() || list.size() > kMostTransforms)
    return bad_sample(fmt::format("transforms is no list of 1 to {}", kMostTransforms));
  geometry::Pose whole;
  const json* before = nullptr;
  for (const json& transform : list) {
    const json* const parent = member(transform, "parentId");
    if (parent != nullptr && before != nullptr && *parent != *before)
      return bad_sample("transforms branch: send those of the camera alone, each after its parent");
    before = member(transform, "id");
    MIXRIG_ASSIGN(const geometry::Pose next, parse_transform(transform));
    whole = whole * next;
  }
  return whole * geometry::Pose{world_from_camera({}), Eigen::Vector3d::Zero()};
}

Result<std::int64_t> parse_time_ns(const json& stamp) {
  const json *const s = member(stamp, "seconds"), *const ns = member(stamp, "nanoseconds");
  if (s == nullptr || ns == nullptr || !s->is_number_integer() || !ns->is_number_integer() ||
      s->get<std::int64_t>() < 0 || s->get<std::int64_t>() >= kMost_s ||
      ns->get<std::int64_t>() < 0 || ns->get<std::int64_t>() > 999'999'999)
    return bad_sample("timing.sampleTimestamp is no time");
  return s->get<std::int64_t>() * 1'000'000'000 + ns->get<std::int64_t>();
}

Result<void> check_protocol(const json& sample) {
  const json* const protocol = member(sample, "protocol");
  if (protocol == nullptr) return bad_sample("the sample names no protocol");
  const json *const name = member(*protocol, "name"), *const version = member(*protocol, "version");
  if (name == nullptr || *name != "OpenTrackIO") return bad_sample("a sample of another protocol");
  if (version == nullptr || !version->is_array() || version->empty() || version->front() != 1)
    return Error{ErrorCode::kUnsupported, "OpenTrackIO: a sample of another version, 1 is read"};
  return {};
}

}  // namespace

Result<OpenTrackReading> parse_opentrack_payload(std::span<const std::byte> payload,
                                                 OpenTrackEncoding encoding) {
  if (payload.size() > kOpenTrackMostBytes) return bad_sample("a sample of more than 64 KiB");
  const json sample = parse_bounded(payload, encoding);
  if (!sample.is_object())
    return bad_sample(encoding == OpenTrackEncoding::kCbor ? "the payload is no CBOR object"
                                                           : "the payload is no JSON object");
  MIXRIG_TRY(check_protocol(sample));
  OpenTrackReading reading;
  if (const json* source = member(sample, "sourceNumber"); source && source->is_number_unsigned())
    reading.source = static_cast<int>(std::min<std::uint64_t>(source->get<std::uint64_t>(), 65535));
  if (const json* tracker = member(sample, "tracker"))
    if (const json* status = member(*tracker, "status"); status && status->is_string())
      reading.status = status->get<std::string>();
  if (const json* timing = member(sample, "timing"))
    if (const json* stamp = member(*timing, "sampleTimestamp")) {
      MIXRIG_ASSIGN(reading.time_ns, parse_time_ns(*stamp));
    }
  if (const json* transforms = member(sample, "transforms")) {
    MIXRIG_ASSIGN(reading.stage_from_camera, parse_transforms(*transforms));
  }
  return reading;
}

Result<OpenTrackSegment> parse_opentrack_datagram(std::span<const std::byte> bytes) {
  using namespace opentrack_bytes;
  if (bytes.size() < kOpenTrackHeaderBytes ||
      std::memcmp(bytes.data(), kMagic.data(), kMagic.size()) != 0)
    return bad_sample("a datagram of another protocol");
  const std::uint32_t length = get_big(bytes, kLengthAt, 2);
  if ((length & ~std::uint32_t{kLastBit}) != bytes.size() - kOpenTrackHeaderBytes)
    return bad_sample("a datagram of another length than it says");
  if (get_big(bytes, kFletcherAt, 2) != fletcher16(bytes))
    return bad_sample("the checksum is wrong");
  const std::uint32_t encoding = get_big(bytes, kEncodingAt, 1);
  if (encoding != 1 && encoding != 2)
    return bad_sample(fmt::format("encoding {}: JSON (1) and CBOR (2) are read", encoding));
  return OpenTrackSegment{static_cast<OpenTrackEncoding>(encoding),
                          static_cast<std::uint16_t>(get_big(bytes, kSequenceAt, 2)),
                          get_big(bytes, kOffsetAt, 4), (length & kLastBit) != 0,
                          bytes.subspan(kOpenTrackHeaderBytes)};
}

}  // namespace mixrig::stream

// SPDX-License-Identifier: Apache-2.0
#include "extras/broadcast/poses/pose_sink.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include <nlohmann/json.hpp>

#include "extras/broadcast/packets/freed.h"

namespace mixrig::session {
namespace {

constexpr std::int64_t kSensorEvery_ns = 2'000'000'000;

std::string_view protocol_name(scene::PoseOut::Protocol protocol) {
  switch (protocol) {
    case scene::PoseOut::Protocol::kFreeD:
      return "freed";
    case scene::PoseOut::Protocol::kOpenTrackJson:
      return "opentrackio";
    case scene::PoseOut::Protocol::kOpenTrackCbor:
      return "opentrackio-cbor";
  }
  return "";
}

/// UUID of version 4 (RFC 9562): random but for its version and variant.
stream::Uuid random_uuid() {
  static thread_local std::mt19937 random{std::random_device{}()};
  stream::Uuid id;
  for (std::uint8_t& byte : id) byte = static_cast<std::uint8_t>(random());
  id[6] = static_cast<std::uint8_t>((id[6] & 0x0F) | 0x40);
  id[8] = static_cast<std::uint8_t>((id[8] & 0x3F) | 0x80);
  return id;
}

std::string_view chars_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// A raw value of an encoder as FreeD has it: 24 bits.
std::uint32_t count_of(double raw) {
  return static_cast<std::uint32_t>(std::clamp(std::round(raw), 0.0, double{0xFFFFFF}));
}

/// Sets a sensor `width_mm` wide with the focal length of the view. The sensor has one focal
/// length, so its height makes up for a difference of fx and fy.
void set_lens(const geometry::Pinhole& view, double width_mm, stream::OpenTrackSample& sample) {
  const Size size = view.size_px;
  const double mm_per_px = width_mm / size.width, mm_per_px_y = mm_per_px * view.fx_px / view.fy_px;
  sample.focal_length_mm = mm_per_px * view.fx_px;
  sample.offset_mm = {mm_per_px * (view.cx_px - 0.5 * (size.width - 1)),
                      mm_per_px_y * (view.cy_px - 0.5 * (size.height - 1))};
  sample.sensor = {width_mm, mm_per_px_y * size.height, size.width, size.height};
}

}  // namespace

Result<std::unique_ptr<PoseSink>> PoseSink::create(const std::vector<scene::PoseOut>& outs,
                                                   EpochReader epoch, std::optional<HostTime> begin,
                                                   std::vector<PoseOutReport>& reports,
                                                   bool (*is_locked)()) {
  std::unique_ptr<PoseSink> sink(new PoseSink(std::move(epoch), begin, reports, is_locked));
  for (const scene::PoseOut& out : outs) {
    auto sender = stream::DatagramSender::open(out.udp);
    if (!sender) return Error{sender.error().code, "pose_out.udp: " + sender.error().context};
    sink->receivers_.push_back({out, *std::move(sender), random_uuid()});
    reports.push_back({std::string(protocol_name(out.protocol)), out.udp});
  }
  return sink;
}

Result<void> PoseSink::write(const output::CompositePtr& composite) {
  const HostTime exposed = composite->capture->mid_exposure;
  if (begin_) shift_ = *begin_ - exposed;
  begin_.reset();
  epoch_ns_ = epoch_.at(exposed + shift_) + shift_.count();
  for (std::size_t i = 0; i < receivers_.size(); ++i) {
    Receiver& to = receivers_[i];
    ++(composite->pose.ok() ? reports_[i].frames : reports_[i].lost_frames);
    if (to.out.protocol == scene::PoseOut::Protocol::kFreeD)
      send_freed(*composite, to);
    else
      send_opentrack(*composite, to);
  }
  return {};
}

void PoseSink::send_freed(const output::Composite& composite, Receiver& to) {
  if (!composite.pose.ok()) return;
  const auto angles = stream::camera_angles(composite.world_from_target.rotation);
  stream::FreeDPacket packet;
  packet.camera = to.out.camera;
  packet.pan_rad = -angles.pan_rad;
  packet.tilt_rad = angles.tilt_rad, packet.roll_rad = angles.roll_rad;
  packet.position_m = composite.world_from_target.translation_m;
  if (const auto& encoders = composite.capture->encoders)
    packet.zoom = count_of(encoders->zoom), packet.focus = count_of(encoders->focus);
  to.sender.send(chars_of(stream::freed_bytes(packet)));
}

void PoseSink::send_opentrack(const output::Composite& composite, Receiver& to) {
  stream::OpenTrackSample sample;
  sample.sample_id = random_uuid(), sample.source_id = to.source;
  sample.source = to.out.camera;
  sample.number = to.samples;
  const UtcTime exposed(Duration(epoch_ns_) + composite.capture->mid_exposure.time_since_epoch());
  const bool is_ptp = to.out.clock == scene::PoseOut::ClockSource::kPtp;
  const Duration stamp =
      is_ptp ? tai_from(exposed, tai_minus_utc_).time_since_epoch() : exposed.time_since_epoch();
  sample.time_ns = std::max<std::int64_t>(0, stamp.count());
  sample.status =
      composite.pose.ok() ? "ok" : "lost: " + std::string(capture::name(composite.pose.loss));
  if (composite.pose.ok()) {
    sample.angles = stream::camera_angles(composite.world_from_target.rotation);
    sample.position_m = composite.world_from_target.translation_m;
  }
  set_lens(composite.view, to.out.sensor_width_mm, sample);
  if (to.samples > 0 && std::abs(sample.time_ns - to.sensor_sent_ns) < kSensorEvery_ns)
    sample.sensor.reset();
  else
    to.sensor_sent_ns = sample.time_ns, to.locked = is_locked_();
  if (to.out.clock != scene::PoseOut::ClockSource::kNotTold)
    sample.synchronization = {is_ptp ? stream::OpenTrackSample::Synchronization::Source::kPtp
                                     : stream::OpenTrackSample::Synchronization::Source::kNtp,
                              to.locked};
  if (const auto& encoders = composite.capture->encoders)
    sample.zoom = encoders->zoom, sample.focus = encoders->focus;
  const auto encoding = to.out.protocol == scene::PoseOut::Protocol::kOpenTrackCbor
                            ? stream::OpenTrackEncoding::kCbor
                            : stream::OpenTrackEncoding::kJson;
  const auto sequence = static_cast<std::uint16_t>(to.samples++);
  const auto payload = stream::opentrack_payload(sample, encoding);
  for (const auto& datagram : stream::opentrack_datagrams(payload, encoding, sequence))
    to.sender.send(chars_of(datagram));
}

Result<void> PoseSink::finish() {
  for (std::size_t i = 0; i < receivers_.size(); ++i)
    reports_[i].datagrams = receivers_[i].sender.sent(),
    reports_[i].dropped = receivers_[i].sender.dropped();
  return {};
}

nlohmann::json to_json(const std::vector<PoseOutReport>& reports) {
  nlohmann::json list = nlohmann::json::array();
  for (const PoseOutReport& r : reports)
    list.push_back({{"protocol", r.protocol},
                    {"udp", r.udp},
                    {"frames", r.frames},
                    {"lost_frames", r.lost_frames},
                    {"datagrams", r.datagrams},
                    {"dropped", r.dropped}});
  return list;
}

}  // namespace mixrig::session

// SPDX-License-Identifier: Apache-2.0
#include "hal/wire/pan_tilt/flir_ptu.h"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

namespace mixrig::device {
namespace {

constexpr Duration kAnswer = std::chrono::seconds(1);
// The unit computes and stores changes of acceleration and of limits before it answers.
constexpr Duration kSlowAnswer = std::chrono::seconds(10);
constexpr Duration kPtuQuiet = std::chrono::milliseconds(60);
constexpr Duration kLeastSamplePeriod = std::chrono::milliseconds(2);
constexpr int kPtuTries = 4;    // tries of an exchange without an answer
constexpr int kQueryTries = 8;  // tries of a query until its answer is valid
constexpr double kRadPerArcsecond = std::numbers::pi / (180.0 * 3600.0);

std::string axis_command(char axis, char what, long value) {
  return std::string{axis, what} + std::to_string(value) + ' ';
}

}  // namespace

FlirPtu::FlirPtu(std::unique_ptr<ByteStream> stream, Clock& clock, std::string uri,
                 Duration byte_time)
    : stream_(std::move(stream)), clock_(clock), byte_time_(byte_time) {
  info_.uri = std::move(uri);
}

Result<std::unique_ptr<FlirPtu>> FlirPtu::open(std::unique_ptr<ByteStream> stream, Clock& clock,
                                               std::string uri, Duration byte_time) {
  std::unique_ptr<FlirPtu> unit(new FlirPtu(std::move(stream), clock, std::move(uri), byte_time));
  MIXRIG_TRY(unit->configure());
  return unit;
}

/// Sets the protocol: no echo, verbose replies, independent axes, immediate moves. The first
/// command is repeated if it is refused: an unplugged cable may have left half a command in the
/// unit, or an answer.
Result<void> FlirPtu::set_up_protocol() {
  MIXRIG_ASSIGN(const PtuReply first, exchange("ED ", kAnswer));
  if (!first.ok) {
    stale_ = true;
    MIXRIG_TRY(command("ED ", kAnswer));
  }
  for (const std::string_view text : {"FV ", "CI ", "I "}) MIXRIG_TRY(command(text, kAnswer));
  return {};
}

Result<void> FlirPtu::configure() {
  MIXRIG_TRY(set_up_protocol());
  MIXRIG_ASSIGN(const PtuReply version, exchange("V ", kAnswer));
  info_.version = version.view();
  MIXRIG_ASSIGN(const double pan_arcsec, query("PR ", PtuAxis::kPan));
  MIXRIG_ASSIGN(const double tilt_arcsec, query("TR ", PtuAxis::kTilt));
  if (!(pan_arcsec > 0 && pan_arcsec < 36000) || !(tilt_arcsec > 0 && tilt_arcsec < 36000))
    return Error{ErrorCode::kDevice,
                 info_.uri + ": pan-tilt unit reports an impossible resolution: check the cable"};
  info_.resolution = {pan_arcsec * kRadPerArcsecond, tilt_arcsec * kRadPerArcsecond};
  MIXRIG_ASSIGN(const double pan_min, query("PN ", PtuAxis::kPan));
  MIXRIG_ASSIGN(const double pan_max, query("PX ", PtuAxis::kPan));
  MIXRIG_ASSIGN(const double tilt_min, query("TN ", PtuAxis::kTilt));
  MIXRIG_ASSIGN(const double tilt_max, query("TX ", PtuAxis::kTilt));
  info_.minimum = {pan_min * info_.resolution.pan_rad, tilt_min * info_.resolution.tilt_rad};
  info_.maximum = {pan_max * info_.resolution.pan_rad, tilt_max * info_.resolution.tilt_rad};
  return {};
}

Result<void> FlirPtu::move_to(PanTiltAngles target) {
  MIXRIG_ASSIGN(const long pan, steps(target.pan_rad, info_.resolution, PtuAxis::kPan));
  MIXRIG_ASSIGN(const long tilt, steps(target.tilt_rad, info_.resolution, PtuAxis::kTilt));
  limits_at_move_ = parser_.pan_limits() + parser_.tilt_limits();
  MIXRIG_TRY(command(axis_command('P', 'P', pan), kAnswer));
  return command(axis_command('T', 'P', tilt), kAnswer);
}

Result<void> FlirPtu::set_motion(PanTiltMotion motion) {
  const auto set = [&](double value_rad, char what, Duration timeout) -> Result<void> {
    if (value_rad == 0) return {};
    const double pan = std::round(value_rad / info_.resolution.pan_rad);
    const double tilt = std::round(value_rad / info_.resolution.tilt_rad);
    if (!(pan >= 1 && pan < 1e6) || !(tilt >= 1 && tilt < 1e6))
      return Error{ErrorCode::kUsage, info_.uri + ": speed or acceleration is out of range"};
    MIXRIG_TRY(command(axis_command('P', what, std::lround(pan)), timeout));
    return command(axis_command('T', what, std::lround(tilt)), timeout);
  };
  MIXRIG_TRY(set(motion.speed_rad_s, 'S', kAnswer));
  return set(motion.acceleration_rad_s2, 'A', kSlowAnswer);
}

Result<PanTiltSample> FlirPtu::sample() {
  PanTiltSample sample;
  clock_.sleep_until(sampled_at_ + kLeastSamplePeriod);
  sampled_at_ = clock_.now();
  MIXRIG_ASSIGN(const double pan, query("PP ", PtuAxis::kPan));
  sample.pan_at = heard_at_;
  MIXRIG_ASSIGN(const double tilt, query("TP ", PtuAxis::kTilt));
  sample.tilt_at = heard_at_;
  sample.angles = {pan * info_.resolution.pan_rad, tilt * info_.resolution.tilt_rad};
  // The protocol has no checksum: a damaged digit is noticed only if the value leaves the range.
  const auto inside = [](double v, double low, double high) { return v >= low && v <= high; };
  const PanTiltAngles& step = info_.resolution;
  if (!inside(sample.angles.pan_rad, info_.minimum.pan_rad - step.pan_rad,
              info_.maximum.pan_rad + step.pan_rad) ||
      !inside(sample.angles.tilt_rad, info_.minimum.tilt_rad - step.tilt_rad,
              info_.maximum.tilt_rad + step.tilt_rad)) {
    stale_ = true;
    return Error{ErrorCode::kDevice, info_.uri +
                                         ": pan-tilt unit reports a position outside its own "
                                         "range: check the cable"};
  }
  return sample;
}

Result<void> FlirPtu::halt() { return command("H ", kAnswer); }

PanTiltHealth FlirPtu::health() const {
  PanTiltHealth health = health_;
  health.limit_hits = parser_.pan_limits() + parser_.tilt_limits();
  health.limit_hit = health.limit_hits > limits_at_move_;
  health.noise_bytes = parser_.noise_bytes();
  return health;
}

Result<void> FlirPtu::command(std::string_view text, Duration timeout) {
  MIXRIG_ASSIGN(const PtuReply reply, exchange(text, timeout));
  if (reply.ok) return {};
  ++health_.refused;
  return Error{ErrorCode::kDevice, info_.uri + ": pan-tilt unit refused '" + std::string(text) +
                                       "': " + std::string(reply.view())};
}

Result<double> FlirPtu::query(std::string_view text, PtuAxis axis) {
  for (int i = 0; i < kQueryTries; ++i) {
    MIXRIG_ASSIGN(const PtuReply reply, exchange(text, kAnswer));
    const PtuAxis reply_axis = ptu_axis(reply.view());
    const auto value = ptu_number(reply.view());
    if (reply.ok && !reply.interrupted && !reply.too_long && value && reply_axis == axis)
      return *value;
    stale_ = true;  // another command's answer, or a damaged one
  }
  return Error{ErrorCode::kDevice, info_.uri + ": pan-tilt unit gives no valid answer to '" +
                                       std::string(text) + "': check the cable and the baud rate"};
}

Result<PtuReply> FlirPtu::exchange(std::string_view text, Duration timeout) {
  for (int i = 0; i + 1 < kPtuTries; ++i) {
    auto reply = exchange_once(text, timeout);
    if (reply || reply.error().code != ErrorCode::kTimeout) return reply;
  }
  return exchange_once(text, timeout);
}

Result<PtuReply> FlirPtu::exchange_once(std::string_view text, Duration timeout) {
  if (lost_) MIXRIG_TRY(set_up_again());
  auto reply = send_and_read(text, timeout);
  if (!reply && reply.error().code == ErrorCode::kDevice) lost_ = true;
  return reply;
}

/// Sets up the protocol after the line is back. The unit may have lost power, and with it its
/// settings.
Result<void> FlirPtu::set_up_again() {
  stale_ = true;
  lost_ = false;
  auto done = set_up_protocol();
  lost_ = !done;
  if (done) ++health_.returns;
  return done;
}

Result<PtuReply> FlirPtu::send_and_read(std::string_view text, Duration timeout) {
  if (stale_) MIXRIG_TRY(drain());
  parser_.expect(text);
  ++health_.commands;
  asked_at_ = clock_.now();
  answer_bytes_ = 0;
  MIXRIG_TRY(stream_->write({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}));
  auto reply = read_reply(clock_.now() + timeout);
  if (reply) {
    heard_at_ = heard_at(text.size());
    return reply;
  }
  stale_ = true;
  if (reply.error().code != ErrorCode::kTimeout) return reply;
  ++health_.timeouts;
  return no_answer(text);
}

/// Estimates when the unit had read the answered question: the question's bytes are on the line
/// before, the answer's after it, and the remaining time is split evenly. An answer that names its
/// axis has ten times as many bytes as the question: the middle of the exchange would be 15 ms late
/// at 9600 baud.
HostTime FlirPtu::heard_at(std::size_t question_bytes) const {
  const Duration passed = clock_.now() - asked_at_;
  const auto question = static_cast<Duration::rep>(question_bytes);
  const auto bytes = question + static_cast<Duration::rep>(answer_bytes_);
  const Duration line = byte_time_ * bytes;
  // The exchange was faster than the stated rate.
  if (line > passed) return asked_at_ + passed * question / bytes;
  return asked_at_ + byte_time_ * question + (passed - line) / 2;
}

Result<PtuReply> FlirPtu::read_reply(HostTime until) {
  std::array<std::uint8_t, 64> bytes;
  while (clock_.now() < until) {
    MIXRIG_ASSIGN(const std::size_t count, stream_->read(bytes, until - clock_.now()));
    answer_bytes_ += count;
    std::optional<PtuReply> reply;
    for (std::size_t i = 0; i < count; ++i) {
      // A second reply in one read belongs to an earlier command: drain before the next one.
      auto next = parser_.feed(static_cast<char>(bytes[i]));
      if (next && reply) stale_ = true;
      if (next && !reply) reply = next;
    }
    if (reply) return *reply;
  }
  return Error{ErrorCode::kTimeout, {}};
}

/// Reads until the line is quiet, so that a late answer is not taken as the next one.
Result<void> FlirPtu::drain() {
  std::array<std::uint8_t, 256> bytes;
  const HostTime end = clock_.now() + kAnswer;
  while (clock_.now() < end) {
    MIXRIG_ASSIGN(const std::size_t count, stream_->read(bytes, kPtuQuiet));
    for (std::size_t i = 0; i < count; ++i) (void)parser_.feed(static_cast<char>(bytes[i]));
    if (count == 0) break;
  }
  stale_ = false;
  return {};
}

Result<long> FlirPtu::steps(double angle_rad, const PanTiltAngles& resolution, PtuAxis axis) const {
  const bool pan = axis == PtuAxis::kPan;
  const double step_rad = pan ? resolution.pan_rad : resolution.tilt_rad;
  const double low_rad = pan ? info_.minimum.pan_rad : info_.minimum.tilt_rad;
  const double high_rad = pan ? info_.maximum.pan_rad : info_.maximum.tilt_rad;
  // Half a step of tolerance: a limit converted to radians and back must be accepted.
  if (angle_rad >= low_rad - step_rad / 2 && angle_rad <= high_rad + step_rad / 2)
    return std::lround(angle_rad / step_rad);
  return Error{ErrorCode::kUsage,
               fmt::format("{}: {} {:.3f} rad is outside {:.3f} .. {:.3f} rad: nothing was moved",
                           info_.uri, pan ? "pan" : "tilt", angle_rad, low_rad, high_rad)};
}

Error FlirPtu::no_answer(std::string_view text) const {
  return Error{ErrorCode::kTimeout, info_.uri + ": pan-tilt unit does not answer '" +
                                        std::string(text) + "': check power, cable and baud rate"};
}

}  // namespace mixrig::device

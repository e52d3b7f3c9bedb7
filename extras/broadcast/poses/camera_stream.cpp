// SPDX-License-Identifier: Apache-2.0
#include "extras/broadcast/poses/camera_stream.h"

#include <atomic>
#include <chrono>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "extras/broadcast/packets/camera_angles.h"
#include "extras/broadcast/packets/freed_receiver.h"
#include "extras/broadcast/packets/opentrackio_receiver.h"
#include "extras/broadcast/poses/arrival_comb.h"
#include "extras/broadcast/poses/stamp_scale.h"
#include "hal/base/guarded.h"
#include "hal/base/log.h"

namespace mixrig::pose {
namespace {

using geometry::Pose;
using Stamps = scene::TrackerStream::Stamps;

constexpr Duration kStreamLook = std::chrono::milliseconds(100);  // at stop_
constexpr double kGapOfCameras_s = 0.1;  // one sample of 25 Hz may be missing
// Resolution of FreeD's angles and positions; OpenTrackIO has more digits.
constexpr double kFreeDTurn_rad = M_PI / 180 / 32768, kFreeDShift_m = 1e-3 / 64;

/// Sample that a protocol read from one datagram.
struct StreamSample {
  double time_s = 0;
  std::optional<TargetSeen> seen;
};

/// Counts and clock of a protocol.
struct StreamState {
  capture::PoseFaults packets;  ///< without the faults of samples
  std::uint64_t count = 0;
  double jitter_s = 0;  ///< of arrival; of stamps it is the track's
};

StreamState state_of(const stream::StreamCounts& counts, long unstamped = 0) {
  const auto unsigned_of = [](long count) { return static_cast<std::uint64_t>(count); };
  StreamState state;
  state.count = unsigned_of(counts.packets);
  state.packets.packets_lost = unsigned_of(counts.lost);
  state.packets.packets_late = unsigned_of(counts.late);
  state.packets.packets_bad = unsigned_of(counts.malformed);
  state.packets.packets_version = unsigned_of(counts.other_version);
  state.packets.packets_foreign = unsigned_of(counts.foreign);
  state.packets.packets_unstamped = unsigned_of(unstamped);
  return state;
}

class FreeDInput {
 public:
  FreeDInput(CameraStreamOptions options, stream::FreeDReceiver receiver)
      : options_(std::move(options)), receiver_(std::move(receiver)), comb_(options_.rate_hz) {}

  Result<std::optional<StreamSample>> next(const Clock& clock) {
    MIXRIG_ASSIGN(const auto packet, receiver_.next(kStreamLook));
    if (!packet) return std::optional<StreamSample>();
    const HostTime now = clock.now();
    const HostTime due = options_.rate_hz > 0 ? comb_.due(now) : now;
    StreamSample sample{seconds(due.time_since_epoch()), {}};
    if (!packet->saturated)
      sample.seen = target_seen(
          Pose{stream::world_from_camera({-packet->pan_rad, packet->tilt_rad, packet->roll_rad}),
               packet->position_m},
          options_);
    warn_of_rate();
    return std::optional(sample);
  }
  StreamState state() const {
    StreamState state = state_of(receiver_.counts());
    if (options_.rate_hz > 0) state.jitter_s = seconds(comb_.jitter());
    return state;
  }

 private:
  void warn_of_rate() {
    if (options_.rate_hz <= 0 || warned_ || comb_.fits()) return;
    warned_ = true;
    log_warning("pose", fmt::format("FreeD: packets do not come at {} Hz: give the sender's rate "
                                    "by camera.rate_hz; until then jitter is not taken out",
                                    options_.rate_hz));
  }

  const CameraStreamOptions options_;
  stream::FreeDReceiver receiver_;
  ArrivalComb comb_;
  bool warned_ = false;
};

class OpenTrackInput {
 public:
  OpenTrackInput(CameraStreamOptions options, stream::OpenTrackReceiver receiver)
      : options_(std::move(options)),
        receiver_(std::move(receiver)),
        scale_(options_.stamps == Stamps::kPtp, tai_minus_utc()) {}

  Result<std::optional<StreamSample>> next(const Clock& clock) {
    MIXRIG_ASSIGN(const auto reading, receiver_.next(kStreamLook));
    if (!reading) return std::optional<StreamSample>();
    if (!reading->time_ns) {
      ++unstamped_;
      return std::optional<StreamSample>();
    }
    if (!first_ns_) first_ns_ = *reading->time_ns;
    StreamSample sample{1e-9 * static_cast<double>(*reading->time_ns - *first_ns_), {}};
    if (options_.stamps != Stamps::kArrival)
      sample.time_s = seconds(host_time(*reading->time_ns, clock).time_since_epoch());
    if (reading->stage_from_camera)
      sample.seen = target_seen(*reading->stage_from_camera, options_);
    return std::optional(sample);
  }
  StreamState state() const { return state_of(receiver_.counts(), unstamped_); }

 private:
  /// The system clock may be set while this runs.
  HostTime host_time(std::int64_t stamp_ns, const Clock& clock) {
    const UtcTime now(Duration(std::chrono::system_clock::now().time_since_epoch()));
    return clock.now() + (scale_.utc_of(stamp_ns, now) - now);
  }

  const CameraStreamOptions options_;
  stream::OpenTrackReceiver receiver_;
  StampScale scale_;
  std::optional<std::int64_t> first_ns_;
  long unstamped_ = 0;
};

std::string text_of(std::string_view protocol, const CameraStreamOptions& options) {
  return fmt::format(
      "{}: {}, {:.0f} ms from exposure to arrival{}; at mid-exposure, at most {:.0f} ms after the "
      "newest sample",
      protocol, options.address, 1e3 * options.delay_s,
      options.stamps == Stamps::kSystem ? " (stamps of the system clock)"
      : options.stamps == Stamps::kPtp  ? " (stamps of PTP)"
                                        : "",
      1e3 * options.most_ahead_s);
}

template <typename Input>
class CameraStream final : public capture::PoseSource {
 public:
  CameraStream(std::string_view protocol, std::string describe, PoseTrackOptions options,
               Input input, const Clock& clock)
      : PoseSource({std::string(protocol), std::move(describe)}),
        track_(options),
        input_(std::move(input)),
        clock_(clock),
        thread_(guarded_thread(
            "receiving", [this] { return listen(); },
            [](const Error& error) {
              log_warning("pose", to_line(error) + ": no more poses are received");
            })) {}
  ~CameraStream() override {
    stop_ = true;
    thread_.join();
  }
  CameraStream(const CameraStream&) = delete;
  CameraStream& operator=(const CameraStream&) = delete;

  capture::CameraPose pose_of(const capture::Capture& capture) override {
    return track_.at(capture.mid_exposure);
  }
  capture::PoseFaults faults() const override {
    capture::PoseFaults all = track_.faults();
    const std::lock_guard lock(mutex_);
    const capture::PoseFaults& packets = state_.packets;
    all.packets_lost = packets.packets_lost, all.packets_late = packets.packets_late;
    all.packets_bad = packets.packets_bad, all.packets_version = packets.packets_version;
    all.packets_foreign = packets.packets_foreign;
    all.packets_unstamped = packets.packets_unstamped;
    return all;
  }
  std::optional<capture::PoseStream> stream() const override {
    capture::PoseStream stream = track_.stream();
    const std::lock_guard lock(mutex_);
    stream.packets = state_.count;
    if (state_.jitter_s > 0) stream.jitter_s = state_.jitter_s;
    return stream;
  }

 private:
  Result<void> listen() {
    while (!stop_) {
      MIXRIG_ASSIGN(const auto sample, input_.next(clock_));
      if (sample) track_.add(sample->time_s, sample->seen, clock_.now());
      const std::lock_guard lock(mutex_);
      state_ = input_.state();
    }
    return {};
  }

  PoseTrack track_;
  Input input_;  ///< of the thread
  const Clock& clock_;
  mutable std::mutex mutex_;  ///< guards what follows
  StreamState state_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

template <typename Input, typename Receiver>
std::unique_ptr<capture::PoseSource> stream_of(const char* protocol, CameraStreamOptions options,
                                               Receiver receiver, bool host_time,
                                               const Clock& clock) {
  std::string describe = text_of(protocol, options);
  const PoseTrackOptions track{options.delay_s, options.most_ahead_s, kGapOfCameras_s, host_time};
  return std::make_unique<CameraStream<Input>>(
      protocol, std::move(describe), track, Input(std::move(options), std::move(receiver)), clock);
}

}  // namespace

TargetSeen target_seen(const Pose& tracker_from_camera, const CameraStreamOptions& options) {
  std::optional<capture::PoseCovariance> covariance;
  if (options.noise) {
    covariance.emplace(capture::PoseCovariance::Zero());
    covariance->diagonal().head<3>().setConstant(std::pow(options.noise->turn_rad, 2) +
                                                 std::pow(kFreeDTurn_rad, 2) / 12);
    covariance->diagonal().tail<3>().setConstant(std::pow(options.noise->shift_m, 2) +
                                                 std::pow(kFreeDShift_m, 2) / 12);
  }
  return on_body(options.world_from_tracker * tracker_from_camera, covariance, options.mount);
}

Result<std::unique_ptr<capture::PoseSource>> open_freed_poses(CameraStreamOptions options,
                                                              const Clock& clock) {
  MIXRIG_ASSIGN(const auto address, stream::parse_freed_address("freed:" + options.address));
  MIXRIG_ASSIGN(auto receiver, stream::FreeDReceiver::open(address));
  return stream_of<FreeDInput>("freed", std::move(options), std::move(receiver), true, clock);
}

Result<std::unique_ptr<capture::PoseSource>> open_opentrack_poses(CameraStreamOptions options,
                                                                  const Clock& clock) {
  MIXRIG_ASSIGN(const auto address,
                stream::parse_opentrack_address("opentrackio:" + options.address));
  MIXRIG_ASSIGN(auto receiver, stream::OpenTrackReceiver::open(address));
  const bool host_time = options.stamps != Stamps::kArrival;
  return stream_of<OpenTrackInput>("opentrackio", std::move(options), std::move(receiver),
                                   host_time, clock);
}

}  // namespace mixrig::pose

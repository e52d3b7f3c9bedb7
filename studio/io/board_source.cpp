// SPDX-License-Identifier: Apache-2.0
#include "studio/io/board_source.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "hal/base/partial_path.h"
#include "host/capture/capture/fisheye.h"
#include "studio/io/board_set.h"
#include "studio/io/source_words.h"
#include "studio/io/stopped.h"
#include "studio/rig.h"
#include "studio/studio.h"

namespace mixrig::studio_io {
namespace {

constexpr int kMostBoardFrames = 100000;
constexpr double kBoardFisheye_hz = 10, kFirstFisheye_s = 0.0137;

geometry::CameraModel designed(const studio::Optics& o) {
  const auto& [k1, k2, p1, p2, k3] = o.distortion;
  return {{o.size_px, o.fx_px, o.fy_px, o.cx_px, o.cy_px},
          geometry::Lens({k1, k2, p1, p2, k3, 0, 0, 0})};
}

take::TakeInfo board_take_info(const studio::BoardInfo& board, int frames, bool fisheye) {
  const studio::BoardOptions& options = board.options;
  const studio::TofSensor tof = studio::tof_sensor(options.rig);
  take::TakeInfo take;
  take.name = board.name;
  take.rate_hz = take.color.rate_hz = take.depth.rate_hz = studio::kFrameRate_hz;
  take.frames = take.color.count = take.depth.count = frames;
  take.amplitude = take.depth;
  take.target = designed(studio::target_optics(options.rig, options.size_px));
  take.tof = designed(tof.optics);
  take.target_from_tof = tof.target_from_tof;
  take.depth_kind = capture::DepthKind::kDistance;
  take.amplitude_is_light = true;
  take.depth_unit_m = tof.unit_m;
  take.noise = {tof.noise.floor_m, tof.noise.linear, tof.noise.quadratic_per_m};
  if (options.second_tof) {
    const studio::TofSensor second = studio::second_sensor(*options.second_tof, options.rig);
    take.tof2 = capture::SecondDepthCamera{
        .model = designed(second.optics),
        .target_from_tof = second.target_from_tof,
        .kind = capture::DepthKind::kDistance,
        .noise = {second.noise.floor_m, second.noise.linear, second.noise.quadratic_per_m},
        .unit_m = second.unit_m,
        .amplitude_is_light = true};
    take.depth2 = take::SecondDepthStream{take.depth, take.depth};
    take.depth2->depth.delay_s = second.delay_s;
  }
  if (!fisheye) return take;
  take.fisheye = take::StreamInfo{{}, 1, 0, kBoardFisheye_hz};
  take.fisheye_rate_hz = kBoardFisheye_hz;
  take.fisheye_px = options.fisheye_px;
  return take;
}

class BoardSource final : public capture::CaptureSource, private capture::RenderedHead {
 public:
  BoardSource(studio::BoardStudio studio, int frames, bool fisheye)
      : studio_(std::move(studio)),
        info_(board_take_info(studio_.info(), frames, fisheye)),
        cameras_(std::make_shared<capture::RigCameras>(info_)) {}

  const studio::BoardInfo& board() const { return studio_.info(); }
  const take::TakeInfo& take() const { return info_; }
  const capture::SourceInfo& info() const override { return info_; }
  capture::RenderedRig rendered() override { return {.head = turns() ? this : nullptr}; }
  Result<bool> read(int number, capture::Capture& capture) override;
  Result<void> read_truth(int, capture::Truth&) override {
    return Error{ErrorCode::kData, "board views have their truth in truth.json"};
  }

 private:
  bool turns() const { return studio_.info().options.pan_tilt; }
  device::PanTiltInfo limits() const override {
    const double step_rad = studio_.info().rig.pan_tilt.step_rad;
    const double most_rad = 0.5 * std::numbers::pi;
    return {{},
            studio_.info().name,
            {step_rad, step_rad},
            {-most_rad, -most_rad},
            {most_rad, most_rad}};
  }
  void turn(const capture::HeadMotion& m) override {
    head_ = {{m.angles.pan_rad, m.angles.tilt_rad},
             {m.rate_rad_s.pan_rad, m.rate_rad_s.tilt_rad},
             m.swing_rad};
  }
  void add_fisheye(capture::Capture& capture);

  studio::BoardStudio studio_;
  const take::TakeInfo info_;
  std::shared_ptr<const capture::RigCameras> cameras_;
  studio::BoardView view_;
  Image<Rgb8> fisheye_;
  int fisheye_number_ = 0;  ///< of `fisheye_`; 0: none yet
  studio::HeadMotion head_;
};

Result<bool> BoardSource::read(int number, capture::Capture& capture) {
  using capture::Stream;
  using capture::StreamStatus;
  if (number > info_.frames) return false;
  const double time_s = (number - 1) / studio::kFrameRate_hz;
  studio_.render_moment(number, time_s, head_, view_);
  capture.number = number;
  capture.time_s = time_s;
  capture.mid_exposure = HostTime(Duration(std::llround(time_s * 1e9)));
  capture.cameras = cameras_;
  capture.tick = 0;
  capture.encoders.reset(), capture.lens.reset(), capture.pan_tilt.reset();
  capture.world_from_target = {}, capture.pose_origin = capture::PoseOrigin::kUnknown;
  capture.status = {};
  capture.set_status(Stream::kPlate, StreamStatus::kFresh);
  capture.set_status(Stream::kDepth, StreamStatus::kFresh);
  if (turns()) {
    capture.pan_tilt = device::PanTiltAngles{view_.pan_rad, view_.tilt_rad};
    capture.set_status(Stream::kPanTilt, StreamStatus::kFresh);
  }
  std::swap(view_.target, capture.plate);
  std::swap(view_.tof_distance_m, capture.depth_m);
  std::swap(view_.tof_amplitude, capture.amplitude);
  capture.depth_mid_exposure = capture.mid_exposure;
  if (info_.depth2) {
    std::swap(view_.tof2_distance_m, capture.depth2.depth_m);
    std::swap(view_.tof2_amplitude, capture.depth2.amplitude);
    capture.depth2.mid_exposure =
        capture.mid_exposure + Duration(std::llround(1e9 * info_.depth2->depth.delay_s));
    capture.set_status(Stream::kDepth2, StreamStatus::kFresh);
  }
  if (info_.fisheye) add_fisheye(capture);
  return true;
}

/// The newest picture that is not after the plate.
void BoardSource::add_fisheye(capture::Capture& capture) {
  const auto newest = static_cast<int>(
      std::floor((capture.time_s - kFirstFisheye_s) * kBoardFisheye_hz + 1 + 1e-9));
  if (newest < 1) return capture::lose_fisheye(capture);
  const double at_s = kFirstFisheye_s + (newest - 1) / kBoardFisheye_hz;
  const bool fresh = newest != fisheye_number_;
  if (fresh) studio_.render_fisheye(newest, at_s, head_, fisheye_);
  fisheye_number_ = newest;
  capture.fisheye = fisheye_;
  capture.fisheye_mid_exposure = HostTime(Duration(std::llround(at_s * 1e9)));
  capture.fisheye_counter = static_cast<std::uint64_t>(newest);
  capture.set_status(capture::Stream::kFisheye,
                     fresh ? capture::StreamStatus::kFresh : capture::StreamStatus::kRepeated);
}

Result<std::unique_ptr<BoardSource>> create(const studio::BoardOptions& options, int frames,
                                            bool fisheye) {
  if (frames < 1 || frames > kMostBoardFrames)
    return Error{ErrorCode::kUsage, "studio: frames must be 1 to 100000"};
  MIXRIG_ASSIGN(studio::BoardStudio studio, studio::BoardStudio::create(options));
  return std::make_unique<BoardSource>(std::move(studio), frames, fisheye);
}

}  // namespace

Result<std::unique_ptr<capture::CaptureSource>> make_board_source(
    const studio::BoardOptions& options, int frames, bool fisheye) {
  MIXRIG_ASSIGN(auto source, create(options, frames, fisheye));
  return std::unique_ptr<capture::CaptureSource>(std::move(source));
}

Result<std::unique_ptr<capture::CaptureSource>> open_board_source(const std::string& words,
                                                                  bool turns) {
  MIXRIG_ASSIGN(const auto word,
                split_words(words, 5, "SEED,RIG,FRAMES,WxH and the fisheye's WxH"));
  studio::BoardOptions options;
  int frames = turns ? kMostBoardFrames : 600;
  MIXRIG_TRY(read_number(word[0], "seed", options.seed));
  if (!word[1].empty()) {
    MIXRIG_ASSIGN(const studio::RigWords rig, studio::parse_rig_words(word[1]));
    options.rig = rig.rig, options.second_tof = rig.second_tof;
  }
  MIXRIG_TRY(read_number(word[2], "number of frames", frames));
  MIXRIG_TRY(read_size(word[3], options.size_px));
  MIXRIG_TRY(read_size(word[4], options.fisheye_px));
  options.pan_tilt = turns;
  return make_board_source(options, frames, !word[4].empty());
}

namespace {

Result<void> write_board_frames(BoardSource& source, int frames, take::TakeWriter& writer,
                                const std::function<void(int)>& progress,
                                const std::atomic<bool>* stop) {
  capture::Capture capture;
  for (int number = 1; number <= frames; ++number) {
    MIXRIG_TRY(source.read(number, capture));
    MIXRIG_TRY(writer.write(capture));
    progress(number);
    MIXRIG_TRY(check_stop(stop, number, frames));
  }
  return write_board_truth(source.board(), writer.staging());
}

}  // namespace

Result<studio::BoardInfo> write_board_take(const studio::BoardOptions& options, int frames,
                                           const std::filesystem::path& folder,
                                           take::StreamFormat format,
                                           const std::function<void(int)>& progress,
                                           const std::atomic<bool>* stop) {
  MIXRIG_ASSIGN(const auto source, create(options, frames, true));
  MIXRIG_ASSIGN(take::TakeWriter writer, take::TakeWriter::create(folder, source->take(), format));
  const Result<void> done = write_board_frames(*source, frames, writer, progress, stop);
  if (!done) {
    writer.discard();
    return done.error();
  }
  MIXRIG_TRY(writer.finish());
  return source->board();
}

}  // namespace mixrig::studio_io

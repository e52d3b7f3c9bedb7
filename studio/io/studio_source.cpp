// SPDX-License-Identifier: Apache-2.0
#include "studio/io/studio_source.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "host/capture/capture/fisheye.h"
#include "studio/io/board_source.h"
#include "studio/io/bracket.h"
#include "studio/io/source_words.h"
#include "studio/io/studio_take.h"
#include "studio/studio.h"

namespace mixrig::studio_io {
namespace {

constexpr int kLongest = 100000;  ///< frames of a studio take

/// The pan-tilt unit of a studio without views, which is moved as it is told.
class StudioHead final : public capture::RenderedHead {
 public:
  explicit StudioHead(studio::Studio& studio) : studio_(studio) {}
  device::PanTiltInfo limits() const override {
    constexpr double kMostPan_rad = std::numbers::pi, kMostTilt_rad = 0.5 * std::numbers::pi;
    const double step_rad = studio_.info().pan_tilt->step_rad;
    return {{},
            studio_.info().name,
            {step_rad, step_rad},
            {-kMostPan_rad, -kMostTilt_rad},
            {kMostPan_rad, kMostTilt_rad}};
  }
  void turn(const capture::HeadMotion& m) override {
    studio_.turn_head({{m.angles.pan_rad, m.angles.tilt_rad},
                       {m.rate_rad_s.pan_rad, m.rate_rad_s.tilt_rad},
                       m.swing_rad});
  }

 private:
  studio::Studio& studio_;
};

/// The camera's control, which takes effect two frames after it was set.
class StudioExposure final : public capture::RenderedExposure {
 public:
  explicit StudioExposure(studio::Studio& studio) : studio_(studio) {
    pending_.fill(kControl.rest_s);
  }
  capture::ExposureLimits limits() const override { return exposure_limits(); }
  double rest_s() const override { return kControl.rest_s; }
  void set(double exposure_s) override { pending_.back() = exposure_s; }
  void next_frame() {
    std::shift_left(pending_.begin(), pending_.end(), 1);
    studio_.set_exposure(pending_.front() == kControl.rest_s ? 1
                                                             : kControl.factor(pending_.front()));
  }

 private:
  static constexpr studio::ExposureControl kControl{};
  studio::Studio& studio_;
  std::array<double, 3> pending_{};  ///< of this frame and of those after it
};

class StudioSource final : public capture::CaptureSource {
 public:
  StudioSource(studio::Studio studio, bool head_moves)
      : studio_(std::move(studio)),
        info_(studio_take_info(studio_.info())),
        cameras_(std::make_shared<capture::RigCameras>(info_)),
        head_(studio_),
        exposure_(studio_),
        head_moves_(head_moves) {
    info_.has_truth = !head_moves;
    info_.fisheye_rate_hz = studio_.info().fisheye_rate_hz;
    if (info_.fisheye_rate_hz > 0) info_.fisheye_px = studio_.info().fisheye.optics.size_px;
  }

  capture::RenderedRig rendered() override {
    return head_moves_ ? capture::RenderedRig{&head_, &exposure_} : capture::RenderedRig{};
  }
  const capture::SourceInfo& info() const override { return info_; }

  Result<bool> read(int number, capture::Capture& capture) override {
    if (head_moves_) exposure_.next_frame();
    studio_.render(number, frame_, head_moves_ ? nullptr : &truth_);
    swap_into(studio_.info(), frame_, capture);
    capture.cameras = cameras_;
    add_fisheye(capture);
    return true;
  }
  Result<void> read_truth(int, capture::Truth& truth) override {
    swap_into(truth_, truth);
    return {};
  }

 private:
  void add_fisheye(capture::Capture& capture);

  studio::Studio studio_;
  capture::SourceInfo info_;
  std::shared_ptr<const capture::RigCameras> cameras_;
  studio::Frame frame_;
  studio::Truth truth_;
  studio::FisheyePicture fisheye_;  ///< the last one that was rendered; number 0: none
  StudioHead head_;
  StudioExposure exposure_;
  const bool head_moves_;
};

/// The newest picture whose frame is not after the capture's.
void StudioSource::add_fisheye(capture::Capture& capture) {
  const int pictures = studio_.info().fisheye_pictures;
  if (pictures == 0) return;
  int number = fisheye_.number;
  while (number < pictures && studio_.fisheye_frame(number + 1) <= capture.number) ++number;
  while (number > 0 && studio_.fisheye_frame(number) > capture.number) --number;
  if (number == 0) return capture::lose_fisheye(capture);
  if (number != fisheye_.number) studio_.render_fisheye(number, fisheye_);
  const HostTime at{Duration(std::llround(fisheye_.time_s * 1e9))};
  const capture::StreamStatus status =
      capture::fisheye_status(fisheye_.frame == capture.number, capture.mid_exposure, at,
                              capture::fisheye_hold(info_.fisheye_rate_hz));
  if (status == capture::StreamStatus::kMissing) return capture::lose_fisheye(capture);
  capture.set_status(capture::Stream::kFisheye, status);
  capture.fisheye = fisheye_.picture;
  capture.fisheye_mid_exposure = at;
  capture.fisheye_counter = static_cast<std::uint64_t>(number);
}

Result<studio::StudioOptions> options_of(const std::string& words) {
  MIXRIG_ASSIGN(const auto word,
                split_words(words, 6, "SCENARIO,SEED,RIG,FRAMES,WxH and the fisheye's WxH"));
  studio::StudioOptions options;
  if (!word[0].empty()) {
    MIXRIG_ASSIGN(options.scenario, studio::parse_scenario(word[0]));
  }
  MIXRIG_TRY(read_number(word[1], "seed", options.seed));
  if (!word[2].empty()) {
    MIXRIG_ASSIGN(const studio::RigWords rig, studio::parse_rig_words(word[2]));
    options.rig = rig.rig, options.second_tof = rig.second_tof;
  }
  if (options.scenario == studio::Scenario::kSweep) options.frames = kLongest;
  MIXRIG_TRY(read_number(word[3], "number of frames", options.frames));
  MIXRIG_TRY(read_size(word[4], options.size_px));
  MIXRIG_TRY(read_size(word[5], options.fisheye_px));
  options.fisheye = !word[5].empty();
  if (options.fisheye && options.scenario == studio::Scenario::kSweep)
    return Error{ErrorCode::kUsage,
                 "--source studio:" + words + ": a sweep whose head is moved has no fisheye"};
  return options;
}

std::pair<std::string, std::string> first_word(const std::string& words) {
  const std::size_t comma = words.find(',');
  return {words.substr(0, comma), comma == std::string::npos ? "" : words.substr(comma + 1)};
}

}  // namespace

Result<std::unique_ptr<capture::CaptureSource>> open_studio_source(const std::string& words) {
  for (const auto& [scenario, turns] : {std::pair("board", false), std::pair("turn", true)})
    if (const auto [first, rest] = first_word(words); first == scenario)
      return open_board_source(rest, turns);
  MIXRIG_ASSIGN(const studio::StudioOptions options, options_of(words));
  MIXRIG_ASSIGN(studio::Studio studio, studio::Studio::create(options));
  const bool head_moves = options.scenario == studio::Scenario::kSweep;
  return std::unique_ptr<capture::CaptureSource>(
      std::make_unique<StudioSource>(std::move(studio), head_moves));
}

}  // namespace mixrig::studio_io

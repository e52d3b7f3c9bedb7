// SPDX-License-Identifier: Apache-2.0
// Plates of a view that stands still at other exposures, by the camera's own control.
#pragma once

#include <atomic>
#include <optional>
#include <vector>

#include "hal/device/camera.h"
#include "host/capture/capture/bracket.h"
#include "host/capture/live/sweep/sweep.h"

namespace mixrig::live {

/// Takes them and puts the exposure back, also when it is destroyed. A control has taken effect
/// when the camera says so (get()), when a frame was exposed after it was set, and when its picture
/// is as much darker or brighter than the last one as it should be (within a factor of 1.3, by the
/// pixels that both show well) and the next picture is as bright: within three seconds and twenty
/// pictures, within a minute where fewer come. Where too few pixels are shown well by both, half a
/// second of frames is waited for instead. Not thread-safe.
class ExposureBracket {
 public:
  static constexpr int kPlates = 3;  ///< of each exposure

  /// Exposures end at nine tenths of `frame_period`, so that no frame is lost. `camera` must
  /// outlive it. Errors: kUnsupported where it has no such control; those of Camera::get().
  static Result<ExposureBracket> create(device::Camera& camera, Duration frame_period);
  ExposureBracket(ExposureBracket&& other) noexcept;
  ExposureBracket& operator=(ExposureBracket&&) = delete;
  ~ExposureBracket();

  /// The plates of a view whose own is `plate`, none where that shows all. Returns with the
  /// exposure put back, which the picture has to show, too; or as soon as `stop` is set. A camera
  /// that refuses a value, or whose picture does not follow, is left at the exposure of the sweep
  /// with one warning, and nothing is taken from then on. Errors: those of the rig; kTimeout where
  /// the picture does not come back to what it was.
  Result<std::vector<capture::BracketPlate>> take(SweepRig& rig, const Image<Rgb8>& plate,
                                                  const std::atomic<bool>& stop, Clock& clock);

 private:
  enum class Step { kDone, kNoEffect, kStopped };
  ExposureBracket(device::Camera& camera, double frames_s, capture::ExposureLimits limits)
      : camera_(&camera), limits_(limits), frames_s_(frames_s), set_s_(frames_s) {}
  Result<void> set(double exposure_s);
  /// Waits for `count` plates that are `ratio` as bright as `last`, which is replaced by the last
  /// of them.
  Result<Step> collect(SweepRig& rig, double ratio, std::size_t count, Image<Rgb8>& last,
                       std::vector<Image<Rgb8>>& plates, const std::atomic<bool>& stop,
                       Clock& clock);
  void give_up(const std::string& why);

  device::Camera* camera_;
  capture::ExposureLimits limits_;
  double frames_s_, set_s_;  ///< of the sweep, and now
  bool given_up_ = false;
};

}  // namespace mixrig::live

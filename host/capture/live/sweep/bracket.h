// SPDX-License-Identifier: Apache-2.0
// Takes plates of a static view at other exposures, through the camera's exposure control.
#pragma once

#include <atomic>
#include <optional>
#include <vector>

#include "hal/device/camera.h"
#include "host/capture/capture/bracket.h"
#include "host/capture/live/sweep/sweep.h"

namespace mixrig::live {

/// Takes plates at other exposures and restores the exposure, also when it is destroyed. A control
/// has taken effect when the camera reports so (get()), a frame was exposed after it was set, its
/// picture is darker or brighter than the last one by the expected ratio (within a factor of 1.3,
/// over the pixels that capture::add_log_ratios() compares), and the next picture is as bright.
/// This must happen within three seconds and twenty pictures, or within a minute if fewer come. If
/// too few pixels can be compared, it waits for half a second of frames instead. Not thread-safe.
class ExposureBracket {
 public:
  static constexpr int kPlates = 3;  ///< plates per exposure

  /// Exposures end at nine tenths of `frame_period`, so that no frame is lost. `camera` must
  /// outlive it. Errors: kUnsupported if it has no such control; those of Camera::get().
  static Result<ExposureBracket> create(device::Camera& camera, Duration frame_period);
  ExposureBracket(ExposureBracket&& other) noexcept;
  ExposureBracket& operator=(ExposureBracket&&) = delete;
  ~ExposureBracket();

  /// Takes the further plates of a view whose own plate is `plate`; none if that is well exposed
  /// everywhere. Returns once the exposure is restored and the picture shows it, or as soon as
  /// `stop` is set. A camera that refuses a value, or whose picture does not follow, is left at the
  /// exposure of the sweep with one warning, and no more plates are taken. Errors: those of the
  /// rig; kTimeout if the picture does not return to what it was.
  Result<std::vector<capture::BracketPlate>> take(SweepRig& rig, const Image<Rgb8>& plate,
                                                  const std::atomic<bool>& stop, Clock& clock);

 private:
  enum class Step { kDone, kNoEffect, kStopped };
  ExposureBracket(device::Camera& camera, double frames_s, capture::ExposureLimits limits)
      : camera_(&camera), limits_(limits), frames_s_(frames_s), set_s_(frames_s) {}
  Result<void> set(double exposure_s);
  /// Waits for `count` plates that are `ratio` times as bright as `last`; then replaces `last` by
  /// the last plate.
  Result<Step> collect(SweepRig& rig, double ratio, std::size_t count, Image<Rgb8>& last,
                       std::vector<Image<Rgb8>>& plates, const std::atomic<bool>& stop,
                       Clock& clock);
  void give_up(const std::string& why);

  device::Camera* camera_;
  capture::ExposureLimits limits_;
  double frames_s_, set_s_;  ///< exposure of the sweep, and the present one
  bool given_up_ = false;
};

}  // namespace mixrig::live

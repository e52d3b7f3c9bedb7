// SPDX-License-Identifier: Apache-2.0
// The sweep of a pan-tilt unit: move, settle, collect, next view.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hal/base/clock.h"
#include "host/capture/capture/bracket.h"
#include "host/capture/capture/capture.h"
#include "host/capture/live/sweep/picture_shift.h"

namespace mixrig::live {

/// What a sweep needs of a rig. For one thread.
class SweepRig {
 public:
  virtual ~SweepRig() = default;
  /// One step of the unit.
  virtual device::PanTiltAngles step() const = 0;
  /// Starts moving. Errors: those of device::PanTilt::move_to.
  virtual Result<void> move_to(device::PanTiltAngles target) = 0;
  /// Stops both axes.
  virtual Result<void> halt() = 0;
  /// The next frames of one moment with the head's angle at mid-exposure; false when none came in
  /// time. `exposed_from` becomes the start of the earliest exposure among them. Errors: kDevice
  /// when there will be no more.
  virtual Result<bool> next(Duration timeout, capture::Capture& frame, HostTime& exposed_from) = 0;
};

struct SweepSettings {
  int view_frames = 4;
  double rest_px = 0.1;                             ///< smaller shifts of the picture do not count
  Duration move_timeout = std::chrono::seconds(5);  ///< without coming nearer to the view
  Duration settle_timeout = std::chrono::seconds(15);  ///< from the arrival to the last frame
  Duration frame_timeout = std::chrono::seconds(5);    ///< without frames
  Duration angle_timeout = std::chrono::seconds(3);    ///< with frames, but no angle of the unit
};

/// Waits for one view and collects its frames. A frame counts if its exposure began after the unit
/// was within half a step of the view by its own word; the first one that counts is the reference.
/// A later one that is shifted against it (colour or depth, shift_between) takes its place, and
/// collecting starts again. The view is taken when as many frames as wanted, at least two, agree.
/// Its memory is reused from view to view. Not thread-safe.
class ViewTaker {
 public:
  ViewTaker(const SweepSettings& settings, device::PanTiltAngles step);

  void begin(device::PanTiltAngles target, HostTime now);
  /// Swaps the pictures of a frame that counts out of `frame`.
  void add(capture::Capture& frame, HostTime exposed_from, HostTime now);
  bool taken() const { return count_ >= wanted_; }
  /// Errors: kTimeout, which one by name; kDevice for a unit that gives no angles.
  Result<void> check(HostTime now) const;
  /// Of a taken view: view_frames of them.
  std::span<const capture::Capture> frames() const;
  /// By the unit, while the frames were taken.
  device::PanTiltAngles angles() const { return *frames_[0].pan_tilt; }
  int restarts() const { return restarts_; }  ///< since construction

 private:
  bool agrees(const capture::Capture& frame);
  void keep(capture::Capture& frame);
  void follow(device::PanTiltAngles at, HostTime now);
  Error not_settled() const;

  const SweepSettings settings_;
  const device::PanTiltAngles step_;
  const std::size_t wanted_;
  std::vector<capture::Capture> frames_;
  std::size_t count_ = 0;
  Image<float> reference_, luminance_;
  device::PanTiltAngles target_;
  std::optional<double> first_away_rad_, away_rad_;  ///< from the view: at first, and least since
  HostTime nearer_{}, framed_{}, angled_{};          ///< when it last came nearer, ...
  std::optional<HostTime> arrived_, stands_;         ///< first; since when without a break
  PictureShift color_shift_, depth_shift_;           ///< of the last frame that did not agree
  int restarts_ = 0;
};

struct SweepOptions {
  SweepSettings settings;
  std::vector<device::PanTiltAngles> views;
  std::size_t first = 0;  ///< views before it are there already
  /// Called after each view with the number that is there and the time that is left.
  std::function<void(std::size_t done, Duration left)> progress;
  /// Takes a view; what it returns ends the sweep where it is an error.
  std::function<Result<void>(std::span<const capture::Capture> frames, device::PanTiltAngles at,
                             std::span<const capture::BracketPlate> bracket)>
      save;
  /// Plates of a view that was taken, at other exposures, while the unit stands; may be empty.
  std::function<Result<std::vector<capture::BracketPlate>>(const Image<Rgb8>& plate)> bracket;
};

struct SweepReport {
  std::size_t views = 0;  ///< that are there
  int bracketed = 0;      ///< of those taken now, with plates at other exposures
  int restarts = 0;       ///< frames that were shifted against those before them
  bool stopped = false;
};

/// Takes the views that are not there yet, one after another, until `stop` is set; then, and after
/// an error that is not the unit's, the unit is halted. Errors: those of the rig, of
/// ViewTaker::check, of `bracket` and of `save`, with the number and angles of the view.
Result<SweepReport> run_sweep(SweepRig& rig, const SweepOptions& options,
                              const std::atomic<bool>& stop, Clock& clock);

}  // namespace mixrig::live

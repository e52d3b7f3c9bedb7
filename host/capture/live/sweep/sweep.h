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

/// Interface of a rig for a sweep. For one thread.
class SweepRig {
 public:
  virtual ~SweepRig() = default;
  /// One step of the unit.
  virtual device::PanTiltAngles step() const = 0;
  /// Starts moving. Errors: those of device::PanTilt::move_to.
  virtual Result<void> move_to(device::PanTiltAngles target) = 0;
  /// Stops both axes.
  virtual Result<void> halt() = 0;
  /// Reads the next frames of one moment with the head's angle at mid-exposure; false if none came
  /// in time. `exposed_from` becomes the start of the earliest exposure among them. Errors: kDevice
  /// if no more can come.
  virtual Result<bool> next(Duration timeout, capture::Capture& frame, HostTime& exposed_from) = 0;
};

struct SweepSettings {
  int view_frames = 4;
  double rest_px = 0.1;                             ///< smaller shifts of the picture are ignored
  Duration move_timeout = std::chrono::seconds(5);  ///< time without getting closer to the view
  Duration settle_timeout = std::chrono::seconds(15);  ///< time from the arrival to the last frame
  Duration frame_timeout = std::chrono::seconds(5);    ///< time without frames
  /// Time with frames, but no angle of the unit.
  Duration angle_timeout = std::chrono::seconds(3);
};

/// Waits for one view and collects its frames. A frame counts if its exposure began after the unit
/// was within half a step of the view by its reported angle; the first frame that counts is the
/// reference. A later one that is shifted against it (colour or depth, shift_between) takes its
/// place, and collecting starts again. The view is taken when as many frames as wanted, at least
/// two, agree. Its memory is reused from view to view. Not thread-safe.
class ViewTaker {
 public:
  ViewTaker(const SweepSettings& settings, device::PanTiltAngles step);

  void begin(device::PanTiltAngles target, HostTime now);
  /// Takes a frame; if it counts, swaps its pictures out of `frame`.
  void add(capture::Capture& frame, HostTime exposed_from, HostTime now);
  bool taken() const { return count_ >= wanted_; }
  /// Checks the time limits. Errors: kTimeout, naming the limit; kDevice for a unit that gives no
  /// angles.
  Result<void> check(HostTime now) const;
  /// Returns the view_frames frames of a taken view.
  std::span<const capture::Capture> frames() const;
  /// Returns the angles that the unit reported while the frames were taken.
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
  /// Angle to the view: at first, and the least since.
  std::optional<double> first_away_rad_, away_rad_;
  /// Last time nearer to the view, with a frame, with an angle.
  HostTime nearer_{}, framed_{}, angled_{};
  /// When the unit first arrived; since when it has been at the view without a break.
  std::optional<HostTime> arrived_, stands_;
  PictureShift color_shift_, depth_shift_;  ///< shift of the last frame that did not agree
  int restarts_ = 0;
};

struct SweepOptions {
  SweepSettings settings;
  std::vector<device::PanTiltAngles> views;
  std::size_t first = 0;  ///< earlier views exist already
  /// Called after each view with the number of finished views and the estimated time left.
  std::function<void(std::size_t done, Duration left)> progress;
  /// Stores a view; an error ends the sweep.
  std::function<Result<void>(std::span<const capture::Capture> frames, device::PanTiltAngles at,
                             std::span<const capture::BracketPlate> bracket)>
      save;
  /// Takes plates of the last view at other exposures while the unit stands; may be empty.
  std::function<Result<std::vector<capture::BracketPlate>>(const Image<Rgb8>& plate)> bracket;
};

struct SweepReport {
  std::size_t views = 0;  ///< number of finished views
  int bracketed = 0;      ///< views taken now with plates at other exposures
  int restarts = 0;       ///< number of frames that were shifted against earlier ones
  bool stopped = false;
};

/// Takes the missing views one after another until `stop` is set. Then, and after an error that is
/// not the unit's, it halts the unit. Errors: those of the rig, of ViewTaker::check, of `bracket`
/// and of `save`, with the number and angles of the view.
Result<SweepReport> run_sweep(SweepRig& rig, const SweepOptions& options,
                              const std::atomic<bool>& stop, Clock& clock);

}  // namespace mixrig::live

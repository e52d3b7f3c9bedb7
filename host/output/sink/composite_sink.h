// SPDX-License-Identifier: Apache-2.0
// Interface of the sinks for composites: files, contact sheet, viewfinder, streams.
#pragma once

#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "hal/base/result.h"
#include "host/capture/capture/capture.h"
#include "host/capture/capture/pose_source.h"
#include "host/capture/capture/truth.h"
#include "host/math/geometry/pose.h"
#include "host/render/contract/compositor.h"

namespace mixrig::output {

/// One composited frame and its inputs.
struct Composite {
  capture::CapturePtr capture;
  std::shared_ptr<const capture::Truth> truth;  ///< null where the source has none
  /// Where people are, in a run that wants it of a source that knows.
  std::optional<std::vector<capture::TruePerson>> true_people;
  geometry::Pose world_from_target;            ///< that was used
  capture::CameraPose pose;                    ///< of the source; where it is lost, why
  geometry::Pinhole view;                      ///< that the images are in
  std::optional<double> slip_px;               ///< of the contact points, against the true pose
  std::optional<double> slip_sigma_px;         ///< the same, predicted from the pose's covariance
  std::optional<render::CameraMotion> motion;  ///< while the plate was exposed, where it is known
  bool objects_shown = true;                   ///< false: hidden, since the pose is lost
  /// Of the scene's objects; empty: where the scene has them.
  std::vector<geometry::Pose> world_from_object;
  render::FrameOutput images;  ///< those of images.wanted are valid
  float frame_ms = 0;          ///< time to composite it
  double foreground_pct = 0;   ///< share of pixels with a matte of at least half

  /// Lets go of the inputs, when the last user has dropped it; the images keep their buffers.
  void recycle() {
    capture.reset();
    truth.reset();
  }
};
/// Dropping the last reference returns the buffers to their pool.
using CompositePtr = std::shared_ptr<const Composite>;

/// wanted() is called on the compositing thread, before write() of any later frame has ended;
/// write() and finish() on the sink's own thread (SinkThread).
class CompositeSink {
 public:
  virtual ~CompositeSink() = default;
  /// Name for reports: "files", "sheet".
  virtual std::string_view name() const = 0;
  /// Images that frame `number` of the source needs for this sink; 0: the frame is not sent to it.
  /// Thread-safe.
  virtual render::OutputMask wanted(int number) const = 0;
  /// May be slow: a sink of a live run then loses frames. Not called again after an error.
  virtual Result<void> write(const CompositePtr& composite) = 0;
  /// True where write() takes some milliseconds at most: its thread has the priority of the run, so
  /// that other programs do not take its time.
  virtual bool is_quick() const { return false; }
  /// After the last write(). Errors: those of the sink.
  virtual Result<void> finish() = 0;
};

}  // namespace mixrig::output

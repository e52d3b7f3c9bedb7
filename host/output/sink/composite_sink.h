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

/// A connected piece of a composite that shows another layer than the truth: its number of pixels
/// and its box, in pixels of the truth.
struct WrongPiece {
  int pixels = 0;
  int x_px = 0, y_px = 0, width_px = 0, height_px = 0;
};

/// One composited frame with its inputs.
struct Composite {
  capture::CapturePtr capture;
  std::shared_ptr<const capture::Truth> truth;  ///< null if the source has none
  /// True places of people; set if the run asks for them and the source knows them.
  std::optional<std::vector<capture::TruePerson>> true_people;
  geometry::Pose world_from_target;  ///< pose used for the composite
  capture::CameraPose pose;          ///< pose by the source; if lost, the reason
  geometry::Pinhole view;            ///< view of the images
  std::optional<double> slip_px;     ///< slip of the contact points against the true pose, pixels
  std::optional<double> slip_sigma_px;  ///< slip predicted from the pose's covariance, pixels
  /// The largest wrong piece, of 0 pixels where there is none; unset if the frame is not judged.
  std::optional<WrongPiece> worst_piece;
  std::optional<render::CameraMotion> motion;  ///< motion during the exposure, if known
  bool objects_shown = true;  ///< false: objects are hidden because the pose is lost
  /// Poses of the scene's objects; empty: as in the scene.
  std::vector<geometry::Pose> world_from_object;
  render::FrameOutput images;  ///< only those in images.wanted are valid
  float frame_ms = 0;          ///< time to composite it, milliseconds
  double foreground_pct = 0;   ///< share of pixels with a matte of at least half

  /// Releases the inputs when the last user has dropped the composite; the images keep their
  /// buffers.
  void recycle() {
    capture.reset();
    truth.reset();
  }
};
/// Dropping the last reference returns the buffers to their pool.
using CompositePtr = std::shared_ptr<const Composite>;

/// A receiver of composites. wanted() is called in the compositing thread, before write() of any
/// later frame has ended; write() and finish() in the sink's own thread (SinkThread).
class CompositeSink {
 public:
  virtual ~CompositeSink() = default;
  /// Name for reports: "files", "sheet".
  virtual std::string_view name() const = 0;
  /// Images that this sink needs of frame `number` of the source; 0: the frame is not sent to it.
  /// Thread-safe.
  virtual render::OutputMask wanted(int number) const = 0;
  /// Takes a composite. If it is slow, the sink of a live run loses frames. Not called again after
  /// an error.
  virtual Result<void> write(const CompositePtr& composite) = 0;
  /// True if write() takes a few milliseconds at most: its thread then has the run's priority, so
  /// that other programs do not delay it.
  virtual bool is_quick() const { return false; }
  /// Called after the last write(). Errors: those of the sink.
  virtual Result<void> finish() = 0;
};

}  // namespace mixrig::output

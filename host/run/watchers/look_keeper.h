// SPDX-License-Identifier: Apache-2.0
// Measures the camera's look again during a run ([look] of the scene).
#pragma once

#include <memory>
#include <optional>

#include <nlohmann/json_fwd.hpp>

#include "hal/base/quantile_sketch.h"
#include "host/run/session/session.h"
#include "host/run/watchers/frame_watch.h"
#include "host/run/watchers/look_follower.h"

namespace mixrig::session {

struct LookReport {
  int looks = 0;                     ///< plates measured after the first
  int moved = 0;                     ///< plates skipped because the camera moved
  render::PictureLook first, last;   ///< complete looks, wanted or not
  measure::QuantileSketch watch_ms;  ///< of one plate, in the watching thread
};
/// docs/reference/report.md has the keys.
nlohmann::json to_json(const LookReport& report);

/// Longest image motion over the exposure, in view pixels, of points at the view's corners and
/// centre, between two metres and infinity. Pure.
glm::vec2 way_of_view_px(const render::CameraMotion& motion, const geometry::Pinhole& view);

class LookSink;

/// For the compositing thread of one run.
class LookKeeper {
 public:
  static constexpr int kLookStep = 6;         ///< frames between measured plates
  static constexpr float kMostWay_px = 0.3F;  ///< less motion is not blurred by pass motion either

  LookKeeper(const Session& session, bool live) : session_(session), live_(live) {}

  /// Opens the watch; it stays closed without objects, or if the scene wants nothing that is
  /// measured, or measures once only.
  void open(WorkGate* gate);
  /// Gives one of kLookStep frames to the watch: one during whose exposure the camera moved by less
  /// than kMostWay_px. Errors: those of an earlier frame.
  Result<void> push(const output::CompositePtr& composite);
  /// Look for the frame of this plate; measures the first plate itself. Null if the watch is
  /// closed.
  const render::PictureLook* look_of(const output::Composite& composite);
  Result<void> finish();
  /// Precondition: finish() was called. Nullopt if the watch was closed.
  std::optional<LookReport> report() const;

 private:
  std::optional<glm::vec2> way_px(const output::Composite& composite) const;

  const Session& session_;
  const bool live_;
  LookFollower follower_;
  render::PictureLook first_;
  int next_look_ = 0, moved_ = 0;
  bool first_is_judged_ = false;  ///< the first plate's motion has been taken into account
  FrameWatch<LookSink> watch_;
};

}  // namespace mixrig::session

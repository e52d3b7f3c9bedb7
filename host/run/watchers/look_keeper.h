// SPDX-License-Identifier: Apache-2.0
// Measures again, while a run goes on, what the camera does to real things ([look] of the scene).
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
  int looks = 0;                     ///< plates that were measured, after the first
  int moved = 0;                     ///< plates that were not, since the camera moved
  render::PictureLook first, last;   ///< all of it, wanted or not
  measure::QuantileSketch watch_ms;  ///< of a plate, on a thread of its own
};
/// docs/reference/report.md has the keys.
nlohmann::json to_json(const LookReport& report);

/// Way over the exposure, in pixels of the view, of what lies between two metres and far away: the
/// longest of its corners and middle. Pure.
glm::vec2 way_of_view_px(const render::CameraMotion& motion, const geometry::Pinhole& view);

class LookSink;

/// For the compositing thread of one run.
class LookKeeper {
 public:
  static constexpr int kLookStep = 6;         ///< frames from one measured plate to the next
  static constexpr float kMostWay_px = 0.3F;  ///< less is not blurred by pass motion either

  LookKeeper(const Session& session, bool live) : session_(session), live_(live) {}

  /// Where the scene wants nothing that is measured, or not again, it stays closed.
  void open(WorkGate* gate);
  /// Gives one of kLookStep frames to the thread: one during whose exposure the camera moved by
  /// less than kMostWay_px. Errors: those of an earlier one.
  Result<void> push(const output::CompositePtr& composite);
  /// For the frame of this plate; the first one is measured here. Null while it is closed.
  const render::PictureLook* look_of(const output::Composite& composite);
  Result<void> finish();
  /// After finish(); nullopt where it was closed.
  std::optional<LookReport> report() const;

 private:
  std::optional<glm::vec2> way_px(const output::Composite& composite) const;

  const Session& session_;
  const bool live_;
  LookFollower follower_;
  render::PictureLook first_;
  int next_look_ = 0, moved_ = 0;
  bool first_is_judged_ = false;  ///< how the camera moved in the first plate
  FrameWatch<LookSink> watch_;
};

}  // namespace mixrig::session

// SPDX-License-Identifier: Apache-2.0
// Rungs that keep a frame within the scene's budget of time, by what they cost on this machine.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "host/run/session/session.h"
#include "host/scene/quality.h"

namespace mixrig::session {

/// One measurement.
struct QualityTrial {
  std::string rungs;  ///< "key votes, light shadows"
  double ms = 0;      ///< median frame
  bool kept = false;  ///< of a step down: it saved time
};

struct QualityChoice {
  double budget_ms = 0;
  scene::Rungs rungs;
  double ms = 0;                     ///< of a frame with them
  std::vector<QualityTrial> trials;  ///< in order; the first is what the scene asks for
  bool fits() const { return ms <= budget_ms; }
};

/// Rungs are left one by one, those first whose error grows least for what they save in mixrig
/// bench, until `measure` says a frame takes at most the budget: focus fast; people cast no shadow;
/// key by votes; nothing casts a shadow; key by depth alone. A step that saves less than 2 % is
/// taken back. `measure`: milliseconds of a frame. Errors: its.
Result<QualityChoice> choose_rungs(
    const scene::Rungs& wanted, bool has_focus, bool has_objects, double budget_ms,
    const std::function<Result<double>(const scene::Rungs&)>& measure);

/// Where the scene has a budget: measures frames of the session's size with its back end and sets
/// scene and setup to the rungs that follow; logs what was chosen. After prepare_background() and
/// prepare_poses(), before the compositor is made; takes some seconds. The frame is the source's
/// next with two made-up people in it, since an empty room costs less. Absent: the scene has no
/// budget. Errors: of reading and compositing; kData where the source has no frame.
Result<std::optional<QualityChoice>> follow_budget(Session& session, int first_frame,
                                                   const Clock& clock);

/// Puts two people-shaped ellipses into depth and plate of a capture: 0.6 times as far as what is
/// there (1.8 m where nothing is known), in inverted colours.
void paint_people(capture::Capture& capture);

nlohmann::json to_json(const QualityChoice& choice);
/// A line for each trial, and what was chosen.
std::string to_text(const QualityChoice& choice);

}  // namespace mixrig::session

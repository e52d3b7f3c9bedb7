// SPDX-License-Identifier: Apache-2.0
// Chooses quality levels that keep a frame within the scene's time budget on this machine.
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

/// One measurement of a set of levels.
struct QualityTrial {
  std::string rungs;  ///< such as "key votes, light shadows"
  double ms = 0;      ///< median frame
  bool kept = false;  ///< the step down was kept, since it saved time
};

struct QualityChoice {
  double budget_ms = 0;
  scene::Rungs rungs;
  double ms = 0;                     ///< milliseconds of a frame with `rungs`
  std::vector<QualityTrial> trials;  ///< in order; the first is what the scene asks for
  bool fits() const { return ms <= budget_ms; }
};

/// Lowers levels one by one until `measure` (milliseconds of a frame) is within the budget, in the
/// order of the least error for the time saved in mixrig bench: focus fast; people cast no shadow;
/// key by votes; nothing casts a shadow; key by depth alone. A step that saves less than 2 % is
/// undone. Errors: those of `measure`.
Result<QualityChoice> choose_rungs(
    const scene::Rungs& wanted, bool has_focus, bool has_objects, double budget_ms,
    const std::function<Result<double>(const scene::Rungs&)>& measure);

/// If the scene has a budget: measures frames of the session's size with its back end, sets scene
/// and setup to the chosen levels, and logs them. Call it after prepare_background() and
/// prepare_poses(), before the compositor is made; takes some seconds. Uses the source's next frame
/// with two painted people in it, since an empty room costs less. Nullopt without a budget. Errors:
/// of reading and compositing; kData if the source has no frame.
Result<std::optional<QualityChoice>> follow_budget(Session& session, int first_frame,
                                                   const Clock& clock);

/// Paints two people-shaped ellipses into depth and plate of a capture: 0.6 times as far as what is
/// there (1.8 m where unknown), in inverted colours.
void paint_people(capture::Capture& capture);

nlohmann::json to_json(const QualityChoice& choice);
/// One line for each trial, and the choice.
std::string to_text(const QualityChoice& choice);

}  // namespace mixrig::session

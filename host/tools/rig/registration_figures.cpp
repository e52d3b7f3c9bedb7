// SPDX-License-Identifier: Apache-2.0
#include "host/tools/rig/registration_figures.h"

#include <fmt/format.h>

#include "host/room/background/frame_views.h"
#include "host/run/session/session.h"

namespace mixrig::tools {

Result<measure::Registration> registration_of(capture::CaptureSource& source,
                                              const std::vector<int>& numbers) {
  MIXRIG_ASSIGN(const render::CompositorSetup setup,
                session::setup_of(source.info(), std::nullopt));
  MIXRIG_ASSIGN(session::FrameViews views,
                session::FrameViews::make(setup, {render::Backend::kCpu, 0}));
  measure::RegistrationMeasure measure;
  capture::Capture frame;
  for (const int number : numbers) {
    MIXRIG_ASSIGN(const bool more, source.read(number, frame));
    if (!more) break;
    MIXRIG_ASSIGN(const render::FrameOutput* const seen, views.of(frame));
    measure.add(seen->warped_depth_m, seen->color);
  }
  return measure.result();
}

nlohmann::json registration_json(const measure::Registration& found) {
  return {{"steps", found.steps},
          {"median_px", found.median_px},
          {"matched_share", found.matched_share},
          {"right_px", found.right_px},
          {"down_px", found.down_px},
          {"outside_px", found.outside_px}};
}

std::string registration_text(const measure::Registration& found) {
  if (!found.known())
    return fmt::format(
        "not known: depth steps and edges have no distance in common ({:.0f} % of {} match)",
        100 * found.matched_share, found.steps);
  return fmt::format(
      "the plate's edges lie {:.1f} px from depth steps (median; {:.0f} % of {} match): {:+.1f} px "
      "to the right, {:+.1f} down, {:+.1f} outside",
      found.median_px, 100 * found.matched_share, found.steps, found.right_px, found.down_px,
      found.outside_px);
}

}  // namespace mixrig::tools

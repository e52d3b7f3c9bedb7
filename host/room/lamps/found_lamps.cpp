// SPDX-License-Identifier: Apache-2.0
#include "host/room/lamps/found_lamps.h"

#include <cmath>

#include <fmt/format.h>

#include "hal/base/log.h"
#include "host/room/lamps/lights.h"
#include "host/room/scan/room_file.h"

namespace mixrig::session {
namespace {

/// In one line: which lamps, how certain their places are, what was refused.
std::string found_text(const RoomLights& found) {
  std::string text = fmt::format("{} found in the room", found.lamps.size());
  for (std::size_t i = 0; i < found.lamps.size(); ++i) {
    const Eigen::Vector3d& p = found.lamps[i].position_m;
    const double sigma_m = std::sqrt(found.search.lamps[i].covariance.diagonal().maxCoeff());
    text += fmt::format("{} ({:.2f}, {:.2f}, {:.2f}) m within {:.0f} mm", i == 0 ? ":" : ",", p.x(),
                        p.y(), p.z(), 1e3 * sigma_m);
  }
  text += fmt::format("; {} bright things are none; their light is {}",
                      found.search.rejected.size(), found.light.usable() ? "measured" : "assumed");
  return text;
}

}  // namespace

Result<void> find_scene_lamps(scene::Scene& scene) {
  if (!scene.light.find_lamps) return {};
  const std::string where = scene.path.string() + ": light.lamps: ";
  if (!scene.background.model || !model::is_room(*scene.background.model))
    return Error{ErrorCode::kFormat,
                 where +
                     "\"find\" needs a scanned room, which shows them: give background.model, "
                     "or the lamps by [[light.lamp]]"};
  LightsOptions options;
  options.room = *scene.background.model;
  options.exposure = scene.light.exposure;
  options.world_from_base = scene.background.world_from_base;
  if (scene.pose_source == scene::PoseSource::kPanTilt)
    options.otherwise_from_base = scene.camera.world_from_base;
  auto found = find_lights(options);
  if (!found) return Error{found.error().code, where + found.error().context};
  scene.light.lamps = found->lamps;
  if (found->light.usable()) scene.light.ambient = found->light.value.ambient;
  if (found->lamps.empty())
    log_warning("session", where + found_text(*found) + ": nothing casts a shadow");
  else
    log_info("session", where + found_text(*found));
  return {};
}

}  // namespace mixrig::session

// SPDX-License-Identifier: Apache-2.0
// mixrig lights: the lamps of a room, into a scene.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include <nlohmann/json.hpp>

#include "hal/base/output_folder.h"
#include "host/room/lamps/lights.h"
#include "host/scene/scene.h"
#include "host/tools/command.h"
#include "host/tools/options.h"

namespace mixrig::tools {
namespace {

struct LightsArguments {
  std::string take, model, poses, poses_camera = "target", calibration, scene, drawing;
  std::vector<std::string> bracket;
  int bracket_frame = 1;
  bool low_lamps = false;
  int threads = 0;
};

void print(const session::RoomLights& found) {
  for (std::size_t i = 0; i < found.lamps.size(); ++i) {
    const geometry::Lamp& lamp = found.lamps[i];
    const lights::FoundLamp& how = found.search.lamps[i];
    std::printf("%s: %.3f %.3f %.3f m, sigma %.0f mm, %.2f x %.2f m, intensity %.2f %.2f %.2f\n",
                lamp.name.c_str(), lamp.position_m.x(), lamp.position_m.y(), lamp.position_m.z(),
                1e3 * std::sqrt(how.covariance.trace()), lamp.size_m.x(), lamp.size_m.y(),
                lamp.intensity.x(), lamp.intensity.y(), lamp.intensity.z());
  }
  for (const auto& rejected : found.search.rejected)
    if (rejected.refusal != lights::Refusal::kFewViews)
      std::printf("no lamp, in %zu pictures: %s\n", rejected.seen.size(),
                  std::string(lights::text_of(rejected.refusal)).c_str());
  if (found.lamps.empty()) std::printf("no lamp\n");
  if (!found.lamps.empty() && !found.light.usable())
    std::printf("%s is assumed: %s\n",
                found.radiance.empty() ? "their intensity" : "how bright they are together",
                found.light.verdict.reason.empty()
                    ? "give the scanned room by --model to measure it"
                    : found.light.verdict.reason.c_str());
}

/// PICTURE,EXPOSURE
Result<session::BracketFile> bracket_file(const std::string& text) {
  const std::size_t comma = text.rfind(',');
  session::BracketFile file{text.substr(0, comma), 0};
  if (comma != std::string::npos && comma > 0) {
    char* end = nullptr;
    file.exposure = std::strtod(text.c_str() + comma + 1, &end);
    if (end == text.c_str() + comma + 1 || *end != 0) file.exposure = 0;
  }
  if (file.exposure > 0 && std::isfinite(file.exposure)) return file;
  return Error{ErrorCode::kUsage,
               "lights: --bracket " + text +
                   ": write PICTURE,EXPOSURE, such as long.png,1 short.png,0.0156"};
}

Result<nlohmann::json> find(const LightsArguments& arguments) {
  MIXRIG_TRY(check_output_file(arguments.drawing, kPngBegin, "--draw"));
  session::LightsOptions options;
  options.take = arguments.take, options.room = arguments.model, options.poses = arguments.poses;
  options.poses_of_fisheye = arguments.poses_camera == "fisheye";
  options.calibration = arguments.calibration, options.drawing = arguments.drawing;
  options.lamps.low_lamps = arguments.low_lamps, options.threads = arguments.threads;
  for (const std::string& text : arguments.bracket) {
    MIXRIG_ASSIGN(session::BracketFile file, bracket_file(text));
    options.bracket.push_back(std::move(file));
  }
  options.bracket_frame = arguments.bracket_frame;
  if (!arguments.scene.empty()) {
    MIXRIG_ASSIGN(const scene::Scene scene, scene::load_scene(arguments.scene));
    options.exposure = scene.light.exposure;
    options.world_from_base = scene.background.world_from_base;
    if (!options.world_from_base && scene.pose_source == scene::PoseSource::kPanTilt)
      options.world_from_base = scene.camera.world_from_base;
  }
  MIXRIG_ASSIGN(const session::RoomLights found, session::find_lights(options));
  print(found);
  if (!arguments.scene.empty()) {
    if (found.lamps.empty())
      return Error{ErrorCode::kData, "lights: no lamp was found: " + arguments.scene +
                                         " stays as it is; --draw shows the candidates"};
    MIXRIG_TRY(session::write_lights(found, arguments.scene));
  }
  return with_end(session::to_json(found), arguments.scene,
                  arguments.scene.empty() ? "give --scene FILE to keep the lamps" : "");
}

}  // namespace

void add_lights_command(Command app, Context& context) {
  auto arguments = std::make_shared<LightsArguments>();
  Command command = app.add_subcommand(
      "lights", "lamps of a room, from a take's fisheye, a scanned room, or both");
  add_take_option(command, arguments->take, "whose fisheye saw the lamps");
  command.add_option("--model", arguments->model,
                     "room written by scan: tells mirror images and white things from lamps, and "
                     "how bright lamps are; without --take its own lamps");
  command.add_option("--poses", arguments->poses,
                     "TUM lines of the take's camera, as track writes them; else the take's own, "
                     "or tracked in --model");
  command.add_option("--poses-camera", arguments->poses_camera, "whose poses these are")
      .one_of({"target", "fisheye"})
      .show_default();
  command.add_option("--calibration", arguments->calibration,
                     "calibration.toml with the fisheye; the take's if not given");
  command.add_option("--scene", arguments->scene,
                     "scene.toml that gets the lamps; it says where the room stands");
  command.add_option("--draw", arguments->drawing,
                     "PNG of a picture with its candidates, lamps green, others red");
  command.add_option("--bracket", arguments->bracket,
                     "PICTURE,EXPOSURE ...: the fisheye's pictures at several exposures, from the "
                     "place of --bracket-frame: how bright lamps are for each other");
  command.add_option("--bracket-frame", arguments->bracket_frame, "frame of the take")
      .positive()
      .show_default();
  command.add_flag("--low-lamps", arguments->low_lamps, "what lies below the camera may be a lamp");
  command.add_option("--threads", arguments->threads, "0: one per core").non_negative();
  command.callback(
      [&context, arguments] { context.action = [arguments] { return find(*arguments); }; });
}

}  // namespace mixrig::tools

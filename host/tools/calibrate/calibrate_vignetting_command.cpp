// SPDX-License-Identifier: Apache-2.0
// mixrig calibrate vignetting: how dark the corners of the colour camera are, from a scanned room.
#include <cstdio>
#include <memory>

#include <nlohmann/json.hpp>

#include "host/capture/calibration_file/calibration.h"
#include "host/room/scan/room_file.h"
#include "host/tools/command.h"

namespace mixrig::tools {
namespace {

struct VignettingArguments {
  std::string room, out;
};

Result<nlohmann::json> take_over(const VignettingArguments& arguments) {
  MIXRIG_ASSIGN(const model::RoomManifest room, model::read_manifest(arguments.room));
  if (room.vignetting.is_none())
    return Error{ErrorCode::kData,
                 arguments.room +
                     ": the overlaps of its views show no dark corners, nothing to "
                     "calibrate"};
  MIXRIG_ASSIGN(calibration_file::Calibration known,
                calibration_file::read_calibration(arguments.out));
  for (calibration_file::CalibratedCamera& camera : known.cameras)
    if (camera.name == "target") {
      camera.vignetting = room.vignetting;
      MIXRIG_TRY(calibration_file::write_calibration(arguments.out, known));
      const double corners_pct = 100 * (1 - 1 / room.vignetting.factor(1));
      std::printf("the corners of the picture are %.1f %% darker than its middle\n", corners_pct);
      return with_end(
          {{"vignetting", {room.vignetting.a, room.vignetting.b}}, {"corners_pct", corners_pct}},
          arguments.out, "");
    }
  return Error{ErrorCode::kUsage, arguments.out + ": has no camera \"target\": calibrate it first"};
}

}  // namespace

void add_calibrate_vignetting_command(Command app, Context& context) {
  auto arguments = std::make_shared<VignettingArguments>();
  Command group = app.group("calibrate", "calibrate cameras and rig");
  Command command = group.add_subcommand(
      "vignetting", "dark corners of the colour camera, as the scan of a room found them");
  command.add_option("ROOM", arguments->room, "folder written by mixrig scan").required();
  command.add_option("--out", arguments->out, "calibration.toml whose camera \"target\" gets them")
      .required();
  command.callback(
      [arguments, &context] { context.action = [arguments] { return take_over(*arguments); }; });
}

}  // namespace mixrig::tools

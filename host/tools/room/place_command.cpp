// SPDX-License-Identifier: Apache-2.0
// mixrig place: an object of a scene onto the surface under a pixel.
#include <cstdio>
#include <memory>

#include <nlohmann/json.hpp>

#include "hal/base/angles.h"
#include "hal/base/output_folder.h"
#include "host/operator/desk/place.h"
#include "host/tools/command.h"
#include "host/tools/options.h"

namespace mixrig::tools {
namespace {

struct PlaceArguments {
  SessionArguments session;
  std::string pixel, rect, object, slide, drawing;
  double turn_deg = 0;
  int frame = 1;
  bool dry = false;
};

/// "A,B". Errors: kUsage, naming the option.
Result<Eigen::Vector2d> parse_pair(const std::string& text, const std::string& option) {
  Eigen::Vector2d pair;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%lf,%lf%c", &pair.x(), &pair.y(), &rest) != 2 ||
      !pair.allFinite() || pair.cwiseAbs().maxCoeff() > 1e5)
    return Error{ErrorCode::kUsage, option + " " + text + ": expected two numbers such as 320,240"};
  return pair;
}

Result<nlohmann::json> place(const PlaceArguments& arguments) {
  MIXRIG_TRY(check_output_file(arguments.drawing, kPngBegin, "--draw"));
  session::PlaceOptions options;
  MIXRIG_ASSIGN(options.session, session_options(arguments.session));
  MIXRIG_ASSIGN(options.click.px, parse_pair(arguments.pixel, "--pixel"));
  if (!arguments.rect.empty()) {
    MIXRIG_ASSIGN(const Eigen::Vector2d rect_px, parse_pair(arguments.rect, "--rect"));
    options.click.rect_px = rect_px;
    if (!(rect_px.minCoeff() > 0))
      return Error{ErrorCode::kUsage,
                   "--rect " + arguments.rect + ": give a width and a height above 0"};
  }
  if (!arguments.slide.empty()) {
    MIXRIG_ASSIGN(options.slide_m, parse_pair(arguments.slide, "--slide"));
  }
  options.frame = arguments.frame, options.object = arguments.object;
  options.turn_rad = arguments.turn_deg * kDeg, options.drawing = arguments.drawing;
  MIXRIG_ASSIGN(const session::Placement placement, session::place_object(options));
  const nlohmann::json json = session::to_json(placement);
  const Eigen::Vector3d& p = placement.world_from_object.translation_m;
  std::printf(
      "%s stands at %.3f %.3f %.3f m; the plane is known to %.2f deg and %.1f mm, %.2f m2 of it "
      "are seen\n",
      placement.object.c_str(), p.x(), p.y(), p.z(), json["normal_sigma_deg"].get<double>(),
      json["offset_sigma_mm"].get<double>(), placement.plane.area_m2);
  if (!arguments.dry) MIXRIG_TRY(session::write_placement(placement, arguments.session.scene));
  return arguments.dry ? with_end(json, {}, "leave --dry-run out to set it")
                       : with_end(json, arguments.session.scene,
                                  "mixrig run " + arguments.session.scene + " --out FOLDER");
}

}  // namespace

void add_place_command(Command app, Context& context) {
  auto arguments = std::make_shared<PlaceArguments>();
  Command command =
      app.add_subcommand("place", "set an object of a scene on the surface under a pixel");
  add_session_options(command, arguments->session);
  command.add_option("--pixel", arguments->pixel, "X,Y of the composite: where it stands")
      .required();
  command.add_option("--rect", arguments->rect,
                     "W,H in pixels around it that belong to the surface; a sixteenth of the "
                     "width if not given");
  command.add_option("--object", arguments->object, "its name; not needed where there is one");
  command.add_option("--turn", arguments->turn_deg, "degrees about the surface's normal")
      .show_default()
      .range(-360.0, 360.0);
  command.add_option("--slide", arguments->slide,
                     "U,V metres in the surface: to the right, and away (on a wall: up)");
  command.add_option("--frame", arguments->frame, "of the source, whose depth is looked at")
      .show_default()
      .range(1, 1000000);
  command.add_option("--draw", arguments->drawing, "PNG of the picture with the plane in green");
  command.add_flag("--dry-run", arguments->dry, "say where, and leave the scene as it is");
  command.callback(
      [&context, arguments] { context.action = [arguments] { return place(*arguments); }; });
}

}  // namespace mixrig::tools

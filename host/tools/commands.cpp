// SPDX-License-Identifier: Apache-2.0
// The subcommands in the order of --help.
#include <map>
#include <string>

#include <nlohmann/json.hpp>

#include "host/tools/command.h"

namespace mixrig::tools {
namespace {

constexpr const char* kLeftOut = "left out of this build";

/// Adds a hidden command whose error says that this build leaves `name` out.
[[maybe_unused]] void add_left_out(Command parent, const std::string& name, Context& context) {
  Command command = parent.add_subcommand(name, kLeftOut);
  command.hide();
  command.accept_anything();
  command.callback([&context, name] {
    context.action = [name]() -> Result<nlohmann::json> {
      return Error{ErrorCode::kUsage,
                   "this build of mixrig leaves '" + name +
                       "' out: build all of it, as docs/reference/build.md says"};
    };
  });
}

/// Puts the commands under the headings of --help. A hidden command has none.
void add_headings(Command app) {
  const std::map<std::string, std::string> headings{{"run", "Composite"},
                                                    {"explain", "Composite"},
                                                    {"place", "Composite"},
                                                    {"plan", "Composite"},
                                                    {"scan", "Room, pose and light"},
                                                    {"track", "Room, pose and light"},
                                                    {"lights", "Room, pose and light"},
                                                    {"learn", "Room, pose and light"},
                                                    {"align", "Room, pose and light"},
                                                    {"record", "Takes"},
                                                    {"info", "Takes"},
                                                    {"new", "Takes"},
                                                    {"studio", "Takes"},
                                                    {"rig", "Bench"},
                                                    {"diag", "Bench"},
                                                    {"trigger", "Bench"},
                                                    {"flash", "Bench"},
                                                    {"calibrate", "Bench"},
                                                    {"bench", "Bench"}};
  for (Command command : app.subcommands()) {
    const CommandText text = command.text();
    if (const auto heading = headings.find(text.name);
        heading != headings.end() && text.about != kLeftOut)
      command.heading(heading->second);
  }
}

}  // namespace

void add_commands(Command app, Context& context) {
  add_run_command(app, context);
  add_scan_command(app, context);
  add_explain_command(app, context);
  add_info_command(app, context);
  add_trigger_command(app, context);
  add_flash_command(app, context);
  add_record_command(app, context);
  add_diag_command(app, context);
  add_rig_command(app, context);
  add_align_command(app, context);
  add_calibrate_external_command(app, context);
  add_calibrate_vignetting_command(app, context);
  add_track_command(app, context);
  add_lights_command(app, context);
#ifdef MIXRIG_EXTRA_PEOPLE
  add_plan_command(app, context);
#else
  add_left_out(app, "plan", context);
#endif
  add_place_command(app, context);
#ifdef MIXRIG_EXTRA_STUDIO
  add_new_command(app, context);
  add_studio_command(app, context);
  add_bench_command(app, context);
#else
  for (const char* name : {"new", "studio", "bench"}) add_left_out(app, name, context);
#endif
#ifdef MIXRIG_EXTRA_MAP
  add_learn_command(app, context);
#else
  add_left_out(app, "learn", context);
#endif
#ifdef MIXRIG_CALIBRATE
  add_calibrate_intrinsics_command(app, context);
  add_calibrate_lens_command(app, context);
  add_calibrate_views_command(app, context);
  add_calibrate_rig_command(app, context);
  add_calibrate_ptu_command(app, context);
#else
  Command calibrate = app.group("calibrate", "calibrate cameras and rig");
  for (const char* name : {"intrinsics", "lens", "views", "rig", "tof", "ptu"})
    add_left_out(calibrate, name, context);
#endif
  add_help_pages_command(app, context);
  add_headings(app);
}

}  // namespace mixrig::tools

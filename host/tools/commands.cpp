// SPDX-License-Identifier: Apache-2.0
// The subcommands, each under its heading of --help.
#include <string>

#include <nlohmann/json.hpp>

#include "host/tools/command.h"

namespace mixrig::tools {
namespace {

/// Adds a hidden command whose error says that this build leaves `name` out.
[[maybe_unused]] void add_left_out(Command parent, const std::string& name, Context& context) {
  Command command = parent.add_subcommand(name, "left out of this build");
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

using AddCommand = void (*)(Command app, Context& context);

/// Adds a command, or one more of a group, under a heading of --help.
void add(Command app, Context& context, const char* heading, AddCommand add_command) {
  add_command(app, context);
  app.subcommands().back().heading(heading);
}

}  // namespace

void add_commands(Command app, Context& context) {
  const auto under = [&](const char* heading) {
    return [&, heading](AddCommand command) { add(app, context, heading, command); };
  };
  const auto composite = under("Composite"), room = under("Room, pose and light"),
             takes = under("Takes"), bench = under("Bench");
  composite(add_run_command);
  composite(add_explain_command);
  composite(add_place_command);
  room(add_scan_command);
  room(add_track_command);
  room(add_lights_command);
  room(add_align_command);
  takes(add_record_command);
  takes(add_info_command);
  takes(add_import_command);
  bench(add_rig_command);
  bench(add_diag_command);
  bench(add_trigger_command);
  bench(add_flash_command);
  bench(add_calibrate_external_command);  // these share one group, and stay side by side
  bench(add_calibrate_vignetting_command);
#ifdef MIXRIG_CALIBRATE
  bench(add_calibrate_intrinsics_command);
  bench(add_calibrate_lens_command);
  bench(add_calibrate_views_command);
  bench(add_calibrate_rig_command);
  bench(add_calibrate_ptu_command);
#else
  Command calibrate = app.group("calibrate", "calibrate cameras and rig");
  for (const char* name : {"intrinsics", "lens", "views", "rig", "tof", "ptu"})
    add_left_out(calibrate, name, context);
#endif
#ifdef MIXRIG_EXTRA_PEOPLE
  composite(add_plan_command);
#else
  add_left_out(app, "plan", context);
#endif
#ifdef MIXRIG_EXTRA_STUDIO
  takes(add_new_command);
  takes(add_studio_command);
  bench(add_bench_command);
#else
  for (const char* name : {"new", "studio", "bench"}) add_left_out(app, name, context);
#endif
#ifdef MIXRIG_EXTRA_MAP
  room(add_learn_command);
#else
  add_left_out(app, "learn", context);
#endif
  add_help_pages_command(app, context);
}

}  // namespace mixrig::tools

// SPDX-License-Identifier: Apache-2.0
// The subcommands in the order of --help.
#include "host/tools/command.h"

namespace mixrig::tools {

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
#endif
  add_place_command(app, context);
#ifdef MIXRIG_EXTRA_STUDIO
  add_studio_command(app, context);
  add_bench_command(app, context);
#endif
#ifdef MIXRIG_EXTRA_MAP
  add_learn_command(app, context);
#endif
#ifdef MIXRIG_CALIBRATE
  add_calibrate_intrinsics_command(app, context);
  add_calibrate_lens_command(app, context);
  add_calibrate_views_command(app, context);
  add_calibrate_rig_command(app, context);
  add_calibrate_ptu_command(app, context);
#endif
  add_help_pages_command(app, context);
}

}  // namespace mixrig::tools

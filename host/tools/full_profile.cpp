// SPDX-License-Identifier: Apache-2.0
#include "host/tools/command.h"

namespace mixrig::tools {

void add_commands(Command app, Context& context) {
  add_board_commands(app, context);
  add_studio_command(app, context);
  add_bench_command(app, context);
  add_learn_command(app, context);
  add_calibrate_intrinsics_command(app, context);
  add_calibrate_lens_command(app, context);
  add_calibrate_views_command(app, context);
  add_calibrate_rig_command(app, context);
  add_calibrate_ptu_command(app, context);
}

}  // namespace mixrig::tools

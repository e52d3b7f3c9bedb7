// SPDX-License-Identifier: Apache-2.0
#include "host/tools/command.h"

namespace mixrig::tools {

void add_commands(Command app, Context& context) { add_board_commands(app, context); }

}  // namespace mixrig::tools

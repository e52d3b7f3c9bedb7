// SPDX-License-Identifier: Apache-2.0
// Options of board views, and the rig that takes them.
#pragma once

#include "studio/board/board_studio.h"

namespace mixrig::studio {

/// Checks the options. Errors: kUsage for a value out of its range.
Result<void> check_board_options(const BoardOptions& options);

/// The rig of these options' seed, with the errors that they ask for. Precondition: checked.
BoardInfo board_info_of(const BoardOptions& options);

}  // namespace mixrig::studio

// SPDX-License-Identifier: Apache-2.0
// Callback for the progress of long work.
#pragma once

#include <functional>
#include <string_view>

namespace mixrig {

/// Called after each of `total` steps of the long work that `what` names.
using ProgressFn = std::function<void(std::string_view what, int done, int total)>;

}  // namespace mixrig

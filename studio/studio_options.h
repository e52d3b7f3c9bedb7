// SPDX-License-Identifier: Apache-2.0
// Options of a virtual studio.
#pragma once

#include "studio/studio.h"

namespace mixrig::studio {

/// Checks the options. Errors: kUsage for a value out of its range, and for two that exclude each
/// other.
Result<void> check_studio_options(const StudioOptions& options);

}  // namespace mixrig::studio

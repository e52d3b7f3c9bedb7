// SPDX-License-Identifier: Apache-2.0
// What the extras of this build (MIXRIG_EXTRAS) add to a session and to its run.
#pragma once

#include <vector>

#include "hal/base/result.h"
#include "host/run/controls/run_extra.h"
#include "host/run/session/extra_poses.h"
#include "host/scene/scene.h"

namespace mixrig::tools {

/// For SessionOptions::extra_poses.
std::vector<session::ExtraPoses> extra_poses();
/// New ones, for one run.
session::RunExtras run_extras();
/// Errors: kUnsupported where the scene asks for what this build leaves out, with its file and key.
Result<void> check_extras(const scene::Scene& scene);

}  // namespace mixrig::tools

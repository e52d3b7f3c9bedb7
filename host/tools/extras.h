// SPDX-License-Identifier: Apache-2.0
// The extras of this build (MIXRIG_EXTRAS), in the one table by which they enter.
#pragma once

#include <vector>

#include "hal/base/result.h"
#include "host/capture/open/source_kinds.h"
#include "host/run/controls/run_extra.h"
#include "host/run/session/extra_poses.h"
#include "host/scene/scene.h"
#include "host/tools/room/map_jobs.h"

namespace mixrig::tools {

/// Sources and devices; those of extras that are left out say so when they are asked for.
session::SourceKinds source_kinds();
/// Null where the extra "map" is left out.
MapJobs map_jobs();
/// For SessionOptions::extra_poses.
std::vector<session::ExtraPoses> extra_poses();
/// New ones, for one run.
session::RunExtras run_extras();
/// Errors: kUnsupported where the scene asks for what this build leaves out, with its file and key.
Result<void> check_extras(const scene::Scene& scene);

}  // namespace mixrig::tools

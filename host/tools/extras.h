// SPDX-License-Identifier: Apache-2.0
// Parts of the extras of this build (MIXRIG_EXTRAS) that commands use: sources, devices, poses,
// jobs. extras.cpp alone names them; commands.cpp adds the commands of extras.
#pragma once

#include <vector>

#include "hal/base/result.h"
#include "host/capture/open/source_kinds.h"
#include "host/run/controls/run_extra.h"
#include "host/run/session/extra_poses.h"
#include "host/scene/scene.h"
#include "host/tools/room/map_jobs.h"

namespace mixrig::tools {

/// Sources and devices of extras by scheme. Those of missing extras return an error that says so.
session::SourceKinds source_kinds();
/// Functions of the extra "map"; all null where it is left out.
MapJobs map_jobs();
/// Pose sources of extras, for SessionOptions::extra_poses.
std::vector<session::ExtraPoses> extra_poses();
/// Makes the additions of extras to one run.
session::RunExtras run_extras();
/// Checks that this build has what the scene needs. Errors: kUnsupported, with file and key of the
/// scene.
Result<void> check_extras(const scene::Scene& scene);

}  // namespace mixrig::tools

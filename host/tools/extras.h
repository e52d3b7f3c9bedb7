// SPDX-License-Identifier: Apache-2.0
// The extras of this build (MIXRIG_EXTRAS), in the one table by which they enter.
#pragma once

#include "host/capture/open/source_kinds.h"
#include "host/tools/room/map_jobs.h"

namespace mixrig::tools {

/// Sources and devices; those of extras that are left out say so when they are asked for.
session::SourceKinds source_kinds();
/// Null where the extra "map" is left out.
MapJobs map_jobs();

}  // namespace mixrig::tools

// SPDX-License-Identifier: Apache-2.0
// What a run does with people and objects beside its pictures, with reason and cost.
#pragma once

#include <vector>

#include "host/run/explain/explain.h"
#include "host/run/report/run_report.h"

namespace mixrig::session {

/// "people", "touch" and "physics". `report`: of the run that was measured.
std::vector<PassLine> people_passes(const Session& session, const RunReport& report);

}  // namespace mixrig::session

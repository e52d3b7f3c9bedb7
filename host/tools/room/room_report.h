// SPDX-License-Identifier: Apache-2.0
// Reports on a scanned room, and on its errors where there is truth.
#pragma once

#include <nlohmann/json.hpp>

#include "host/room/sweep/room_scan.h"

namespace mixrig::tools {

/// Prints the errors and returns them as JSON: mean_mm, max_mm, p95_mm and the number of lengths by
/// axis (width, depth, height); p50_mm, p95_mm and over_20mm_pct of the surface.
nlohmann::json errors_json(const measure::RoomErrors& errors);

/// Prints the figures of a scan, faults of its sweep and its errors, and returns them as JSON.
/// `seconds` counts from the first frame to the written room.
nlohmann::json room_report(const session::RoomScan& room, double write_seconds);

}  // namespace mixrig::tools

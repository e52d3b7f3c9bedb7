// SPDX-License-Identifier: Apache-2.0
// What is said of a scanned room, and of its errors where there is truth.
#pragma once

#include <nlohmann/json.hpp>

#include "host/room/sweep/room_scan.h"

namespace mixrig::tools {

/// Prints them and returns them as JSON: mean_mm, max_mm, p95_mm and the number of lengths by axis
/// (width, depth, height), and of the surface p50_mm, p95_mm and over_20mm_pct.
nlohmann::json errors_json(const measure::RoomErrors& errors);

/// Prints what a scan made, what is wrong with its sweep and its errors, and returns it as JSON;
/// its `seconds` are those from the first frame to the written room.
nlohmann::json room_report(const session::RoomScan& room, double write_seconds);

}  // namespace mixrig::tools

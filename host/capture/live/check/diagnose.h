// SPDX-License-Identifier: Apache-2.0
// Diagnoses a rig: opens every device, watches it for a while and judges it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "hal/base/clock.h"
#include "host/capture/capture/grey_card.h"
#include "host/capture/live/play/player.h"
#include "host/capture/live/rig/rig_config.h"
#include "host/capture/live/session/live_session.h"

namespace mixrig::live {

enum class Verdict { kPass, kWarn, kFail };
std::string_view name(Verdict verdict);

/// One check: a line of the table.
struct Check {
  std::string device;  ///< name in rig.toml, or "host"
  std::string what;    ///< "open", "rate", "pairing", ...
  Verdict verdict = Verdict::kPass;
  std::string value;   ///< measured value with its unit
  std::string advice;  ///< what to do; empty on pass
};

struct DiagnoseOptions {
  Duration watch = std::chrono::seconds(5);
  bool move_head = true;  ///< move it a few degrees to measure repeatability
  std::filesystem::path disk = ".";
  bool grey_card = false;  ///< the target camera sees a grey card: judge its colour (check_card)
  std::optional<capture::CardArea> card_area;  ///< pixels of the card; absent: the middle fifth
};

/// Diagnoses all devices. Never fails: a device that cannot be opened is a failed check, and the
/// others are still checked.
std::vector<Check> diagnose(const RigConfig& rig, DeviceOpener opener,
                            const DiagnoseOptions& options, Clock& clock);

/// Makes the checks of one stream from its counts over `watched_s` seconds.
std::vector<Check> judge_stream(const StreamReport& report, double nominal_rate_hz,
                                double watched_s, bool triggered);
/// Judges the trigger edges that this host received. `master`: a master reports ticks, and the
/// edges were compared with them.
Check judge_edges(const sync::EdgeCounts& edges, double nominal_rate_hz, double watched_s,
                  bool master);
/// Judges the spread of repeated positions at one target, in steps of the head.
Check judge_repeatability(const std::vector<device::PanTiltAngles>& positions,
                          device::PanTiltAngles step);
/// Returns the worst verdict; kPass without checks.
Verdict worst(const std::vector<Check>& checks);

}  // namespace mixrig::live

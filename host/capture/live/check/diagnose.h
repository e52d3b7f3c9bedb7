// SPDX-License-Identifier: Apache-2.0
// Health of a rig: every device opened, watched for a while and judged.
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

/// One line of the table.
struct Check {
  std::string device;  ///< name in rig.toml, or "host"
  std::string what;    ///< "open", "rate", "pairing", ...
  Verdict verdict = Verdict::kPass;
  std::string value;   ///< what was measured, with its unit
  std::string advice;  ///< what to do; empty on pass
};

struct DiagnoseOptions {
  Duration watch = std::chrono::seconds(5);
  bool move_head = true;  ///< a few degrees, for repeatability
  std::filesystem::path disk = ".";
  bool grey_card = false;  ///< the target camera sees one: its colour is judged (check_card)
  std::optional<capture::CardArea> card_area;  ///< its pixels; absent: the middle fifth
};

/// Never fails: a device that cannot be opened is a failed check, and the others are still checked.
std::vector<Check> diagnose(const RigConfig& rig, DeviceOpener opener,
                            const DiagnoseOptions& options, Clock& clock);

/// Only judges: checks of one stream from its counts of `watched_s` seconds.
std::vector<Check> judge_stream(const StreamReport& report, double nominal_rate_hz,
                                double watched_s, bool triggered);
/// Judges the trigger edges that this host received. `master`: a master reports ticks, and the
/// edges were compared with them.
Check judge_edges(const sync::EdgeCounts& edges, double nominal_rate_hz, double watched_s,
                  bool master);
/// Judges the spread of repeated positions at one target, in steps of the head.
Check judge_repeatability(const std::vector<device::PanTiltAngles>& positions,
                          device::PanTiltAngles step);
/// Worst of all; kPass when there are none.
Verdict worst(const std::vector<Check>& checks);

}  // namespace mixrig::live

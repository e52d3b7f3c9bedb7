// SPDX-License-Identifier: Apache-2.0
// Health of a rig: every device opened, watched for a while and judged.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "hal/base/clock.h"
#include "host/rig/live_session.h"
#include "host/rig/player.h"
#include "host/rig/rig_config.h"

namespace mixrig::rig {

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
  PlayableOpener playable = {};  ///< of take: and studio: devices
};

/// Never fails: a device that cannot be opened is a failed check, and the others are still looked
/// at.
std::vector<Check> diagnose(const RigConfig& rig, const DiagnoseOptions& options, Clock& clock);

/// The judging alone: what the counts of `watched` seconds say about one stream.
std::vector<Check> judge_stream(const StreamReport& report, double nominal_rate_hz,
                                double watched_s, bool triggered);
/// What the host itself saw of the trigger. `master`: there is a word of the master to hold it
/// against.
Check judge_edges(const sync::EdgeCounts& edges, double nominal_rate_hz, double watched_s,
                  bool master);
/// Spread of the positions that came back for one target, against the step of the head.
Check judge_repeatability(const std::vector<device::PanTiltAngles>& positions,
                          device::PanTiltAngles step);
/// Worst of all; kPass when there are none.
Verdict worst(const std::vector<Check>& checks);

}  // namespace mixrig::rig

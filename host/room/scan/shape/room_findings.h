// SPDX-License-Identifier: Apache-2.0
// Names faults of a sweep and of its room.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host/room/scan/panorama/panorama.h"
#include "host/room/scan/panorama/view_alignment.h"

namespace mixrig::model {

enum class FindingKind : std::uint8_t {
  kTurnedView,       ///< disagreed with its neighbours until turned; value: degrees
  kDisagreeingView,  ///< disagrees, and no turn corrects it; value: millimetres
  kUncheckedView,    ///< overlaps with no other view; value: samples
  kSaturatedView,    ///< white in all exposures, placed at the middle; value: per cent of its plate
  kEmptyView,        ///< little depth; value: per cent of its pixels with depth
  kUnseen,           ///< no view looks there, but views are around; value: square degrees
  kWithoutDepth,     ///< views look there and measure nothing; value: square degrees
  kBehindWall,       ///< surfaces behind a plane that goes on around; value: square degrees
  kBeforeWall,       ///< surfaces that float before a plane; value: square degrees
  kWrapped,  ///< floating surfaces too noisy: a mirror's depth, left out; value: square degrees
};

struct Finding {
  FindingKind kind = FindingKind::kTurnedView;
  int view = 0;  ///< 1-based; 0: the finding concerns the room
  double azimuth_deg = 0, elevation_deg = 0;
  double value = 0;
};

std::string_view name(FindingKind kind);
/// One sentence: what, where, and what it means for the model.
std::string text_of(const Finding& finding);

/// Input of find_faults(): a finished scan.
struct ScannedRoom {
  std::span<const ScanView> views;
  const geometry::CameraModel& target;
  const Alignment& alignment;
  const Panorama& panorama;
  /// Field that the sweep was to cover, pan x tilt around ahead, degrees. Without it, an area that
  /// no view shows is a fault only where views are around it, and nothing is known about the
  /// border.
  std::optional<Size> field_deg{};
};

/// Findings of views in their order, then those of the room, the largest first.
std::vector<Finding> find_faults(const ScannedRoom& room);

}  // namespace mixrig::model

// SPDX-License-Identifier: Apache-2.0
// Chooses the patches of a room that a camera sees. Private to this module.
#pragma once

#include <array>
#include <vector>

#include "host/math/geometry/any_camera.h"
#include "host/math/geometry/pose.h"
#include "host/pose/tracker/patch_map.h"

namespace mixrig::tracking {

/// Chooses patches for each picture and level; does not allocate after construction.
class PatchChoice {
 public:
  /// `patches`: largest number per picture. The map must outlive it.
  PatchChoice(const PatchMap& map, const geometry::AnyCamera& camera, int patches);

  /// Returns patches whose pixels are between 0.71 and 1.41 pixels of picture level k, that face
  /// the camera and are not hidden; the best of each of equally large cells of the picture.
  const std::vector<const Patch*>& choose(const geometry::Pose& camera_from_room, int k);

 private:
  struct Best {
    const Patch* patch;
    float score;
  };
  const PatchMap& map_;
  const geometry::AnyCamera& camera_;
  std::array<int, 2> cells_{};  ///< columns, rows
  static constexpr std::size_t kPerCell = 3;
  std::vector<std::array<Best, kPerCell>> best_;
  std::vector<const Patch*> chosen_;
  std::size_t most_;
};

}  // namespace mixrig::tracking

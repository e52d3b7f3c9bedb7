// SPDX-License-Identifier: Apache-2.0
// How far the surface of a ToF sample is extended past it, towards a sample of another surface.
#pragma once

#include "host/render/cpu/plate/correct.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render::cpu {

class SurfaceReach {
 public:
  SurfaceReach(const WarpParams& params, const Image<glm::vec2>& tof_ray, const TofGrid& grid)
      : params_(params), tof_ray_(tof_ray), grid_(grid) {}

  /// Extension from the known sample (x, y) towards its neighbour (x + dx, y + dy) inside the
  /// picture, along x or y. In halves of a ToF pixel; 1 if both are of one surface.
  float towards(int x, int y, int dx, int dy) const;

 private:
  float by_sight(int x, int y, int dx, int dy, float w, float other_w) const;

  const WarpParams& params_;
  const Image<glm::vec2>& tof_ray_;
  const TofGrid& grid_;
};

}  // namespace mixrig::render::cpu

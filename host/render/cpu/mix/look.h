// SPDX-License-Identifier: Apache-2.0
// Pass look: gives virtual things the noise and sharpness of the plate (look_filter.h).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "hal/base/parallel.h"
#include "host/render/cpu/virtual/virtual.h"
#include "host/render/frame/look_filter.h"

namespace mixrig::render::cpu {

/// Adds grain to shaded colour.
struct GrainOf {
  Grain grain;
  Image<PackedNormal> noise;
  glm::ivec2 offset{0};  ///< of this frame, texels

  bool any() const { return !noise.empty(); }
  /// A colour scaled by kLinearOne, premultiplied by `coverage` (0 to 1, not 0), with the grain of
  /// pixel (x, y) added.
  glm::vec3 added(const glm::vec3& color, float coverage, int x, int y) const;
};

/// Memory of the blur.
struct BlurScratch {
  /// to_differences() of a thread's band, filtered along rows.
  std::vector<Image<glm::vec4>> across;
  VirtualLayer layer;  ///< the filtered layer: rect, coverage, w and color
};

/// Filters colour and coverage of `from` into scratch.layer. A pixel that only the blur covers
/// takes the depth of the nearest pixel that it is blurred from. Allocates in the first frame only.
void blur_layer(Crew& crew, const LookFilter& filter, const VirtualLayer& from,
                BlurScratch& scratch);

}  // namespace mixrig::render::cpu

// SPDX-License-Identifier: Apache-2.0
// Light of the ceiling panels: fixed samples on each, one bit a sample.
#pragma once

#include <array>

#include "host/studio/studio.h"
#include "host/studio/tracer.h"

namespace mixrig::studio {

constexpr int kMaxLamps = 4;
/// Bit 16 l + s stands for sample s of lamp l.
using LampMask = std::uint64_t;

/// A box in world axes that holds a scene's triangles.
struct Bounds {
  Vec3 low{1, 1, 1}, high{-1, -1, -1};  ///< empty where low > high
  bool empty() const { return low.x() > high.x(); }
};
Bounds bounds_of(const Mesh& mesh);

/// Boxes around a mesh: one around all, and closer ones around slices of its height.
struct Extent {
  Bounds whole;
  std::array<Bounds, 10> slices;
};
Extent extent_of(const Mesh& mesh);

/// Four panels of one tint. Immutable and thread-safe.
class LampSet {
 public:
  explicit LampSet(const Light& light);

  /// Samples that a surface turns to.
  LampMask facing(const Vec3& position, const Vec3& normal) const;
  /// Those of `wanted` that `scene` leaves open. `extent` (of the scene) skips lamps whose light
  /// cannot meet it; null asks the tracer every time.
  LampMask open(const TraceScene& scene, const Extent* extent, const Vec3& origin,
                LampMask wanted) const;
  /// Mean over each panel of cos cos / d^2, open samples only, summed over the lamps with their
  /// strength; times tint() it is irradiance.
  float irradiance(const Vec3& position, const Vec3& normal, LampMask open) const;
  const Vec3& tint() const { return tint_; }

 private:
  using Lane = std::array<float, kLampSamples>;
  struct Lamp {
    Vec3 centre, direction;
    float half_x = 0, half_y = 0, strength = 1;
    std::array<Vec3, kLampSamples> samples;
    Lane x, y, z;
  };
  std::vector<Lamp> lamps_;
  Vec3 tint_;
};

}  // namespace mixrig::studio

// SPDX-License-Identifier: Apache-2.0
// Light of the ceiling panels: fixed samples on each panel, one bit per sample.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "studio/studio.h"
#include "studio/tracer.h"

namespace mixrig::studio {

constexpr int kMaxLamps = 4;
/// Bit 16 l + s stands for sample s of lamp l.
using LampMask = std::uint64_t;

/// An axis-aligned bounding box in world axes.
struct Bounds {
  Vec3 low{1, 1, 1}, high{-1, -1, -1};  ///< empty if low > high
  bool empty() const { return low.x() > high.x(); }
};
Bounds bounds_of(const Mesh& mesh);

/// Bounding boxes of a mesh: one of all triangles, and tighter ones of slices along z.
struct Extent {
  Bounds whole;
  std::array<Bounds, 10> slices;
};
Extent extent_of(const Mesh& mesh);

/// Up to four panels of one tint. A sample is open if nothing blocks its light. Immutable and
/// thread-safe.
class LampSet {
 public:
  explicit LampSet(const Light& light);

  /// Samples in front of a surface whose panel emits towards it.
  LampMask facing(const Vec3& position, const Vec3& normal) const;
  /// Samples of `wanted` that `scene` does not block. With `extent` (of the scene) lamps whose
  /// light cannot hit it are not traced; null traces all.
  LampMask open(const TraceScene& scene, const Extent* extent, const Vec3& origin,
                LampMask wanted) const;
  /// Mask of visible lamps with one ray to each lamp's middle, for light that is spread out anyway.
  LampMask open_middle(const TraceScene& scene, const Vec3& origin, LampMask wanted) const;
  /// Sum over the lamps of strength times the panel's mean of cos cos / d^2 over open samples.
  /// Multiplied by tint() it is the irradiance.
  float irradiance(const Vec3& position, const Vec3& normal, LampMask open) const;
  const Vec3& tint() const { return tint_; }
  /// Calls use(direction to it, unit; its part of irradiance()) for each open sample.
  template <typename Use>
  void each_open(const Vec3& position, const Vec3& normal, LampMask open, Use&& use) const {
    for (std::size_t l = 0; l < lamps_.size(); ++l)
      for (int s = 0; s < kLampSamples; ++s) {
        if (((open >> (16 * l + s)) & 1U) == 0) continue;
        const Vec3 to = lamps_[l].samples[s] - position;
        const float d2 = to.squaredNorm(), receiver = std::max(0.0F, normal.dot(to)),
                    emitter = std::max(0.0F, -lamps_[l].direction.dot(to));
        use(to / std::sqrt(d2), lamps_[l].strength * receiver * emitter / (d2 * d2 * kLampSamples));
      }
  }

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

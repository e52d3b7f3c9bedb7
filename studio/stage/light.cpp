// SPDX-License-Identifier: Apache-2.0
// Light of the ceiling panels.
#include "studio/stage/light.h"

#include <algorithm>
#include <cassert>

namespace mixrig::studio {
namespace {

constexpr int kSide = 4;  ///< regular grid, the same for every pixel: no noise
static_assert(kSide * kSide == kLampSamples);

/// Whether the rays from `p` to a panel (half sizes hx, hy around `centre`) can hit the box. The
/// bundle's width grows in proportion to the distance from `p`.
bool can_hit(const Bounds& box, const Vec3& p, const Vec3& centre, float hx, float hy) {
  const Vec3 d = centre - p;
  float from = 0, to = 1;
  if (d.z() > 1e-6F) {
    from = std::max(from, (box.low.z() - p.z()) / d.z());
    to = std::min(to, (box.high.z() - p.z()) / d.z());
  }
  const float margin = 1e-3F;
  const Vec3 grow(hx * std::max(to, 0.0F) + margin, hy * std::max(to, 0.0F) + margin, 0);
  for (int i = 0; i < 2; ++i) {
    const float low = box.low[i] - grow[i] - p[i], high = box.high[i] + grow[i] - p[i];
    if (std::abs(d[i]) < 1e-6F) {
      if (low > 0 || high < 0) return false;
      continue;
    }
    const float a = low / d[i], b = high / d[i];
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
  return from <= to;
}

bool can_hit(const Extent& extent, const Vec3& p, const Vec3& centre, float hx, float hy) {
  if (!can_hit(extent.whole, p, centre, hx, hy)) return false;
  return std::any_of(extent.slices.begin(), extent.slices.end(), [&](const Bounds& slice) {
    return !slice.empty() && can_hit(slice, p, centre, hx, hy);
  });
}

void grow(Bounds& box, const Vec3& p) {
  box = box.empty() ? Bounds{p, p} : Bounds{box.low.cwiseMin(p), box.high.cwiseMax(p)};
}

}  // namespace

Bounds bounds_of(const Mesh& mesh) {
  Bounds box;
  for (const Vec3& p : mesh.positions) grow(box, p);
  return box;
}

Extent extent_of(const Mesh& mesh) {
  Extent extent;
  extent.whole = bounds_of(mesh);
  const float low = extent.whole.low.z(), height = extent.whole.high.z() - low;
  const auto count = static_cast<float>(extent.slices.size());
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    // A triangle belongs to the slice of its first corner.
    const float share = (mesh.positions[mesh.indices[i]].z() - low) / std::max(height, 1e-6F);
    Bounds& slice =
        extent.slices[static_cast<std::size_t>(std::clamp(share * count, 0.0F, count - 1))];
    for (std::size_t k = 0; k < 3; ++k) grow(slice, mesh.positions[mesh.indices[i + k]]);
  }
  return extent;
}

LampSet::LampSet(const Light& light) {
  assert(!light.lamps.empty() && light.lamps.size() <= kMaxLamps);
  tint_ = light.lamps.front().intensity;
  for (const Panel& panel : light.lamps) {
    Lamp lamp;
    lamp.centre = panel.position_m.cast<float>();
    lamp.direction = panel.direction.cast<float>();
    lamp.half_x = 0.5F * static_cast<float>(panel.size_m.x());
    lamp.half_y = 0.5F * static_cast<float>(panel.size_m.y());
    lamp.strength = panel.intensity.sum() / tint_.sum();
    for (int s = 0; s < kLampSamples; ++s) {
      const float u = (static_cast<float>(s % kSide) + 0.5F) / kSide * 2 - 1;
      const float v = (static_cast<float>(s / kSide) + 0.5F) / kSide * 2 - 1;
      const Vec3 at = lamp.centre + Vec3(u * lamp.half_x, v * lamp.half_y, 0);
      lamp.samples[s] = at;
      lamp.x[s] = at.x(), lamp.y[s] = at.y(), lamp.z[s] = at.z();
    }
    lamps_.push_back(lamp);
  }
}

LampMask LampSet::facing(const Vec3& position, const Vec3& normal) const {
  LampMask mask = 0;
  for (std::size_t l = 0; l < lamps_.size(); ++l) {
    const Lamp& lamp = lamps_[l];
    std::array<std::uint32_t, kLampSamples> seen;
    for (int s = 0; s < kLampSamples; ++s) {
      const float x = lamp.x[s] - position.x(), y = lamp.y[s] - position.y(),
                  z = lamp.z[s] - position.z();
      const float receiver = x * normal.x() + y * normal.y() + z * normal.z();
      const float emitter =
          -(x * lamp.direction.x() + y * lamp.direction.y() + z * lamp.direction.z());
      seen[s] = receiver > 0 && emitter > 0 ? 1U << s : 0U;
    }
    std::uint32_t bits = 0;
    for (const std::uint32_t bit : seen) bits |= bit;
    mask |= static_cast<LampMask>(bits) << (16 * l);
  }
  return mask;
}

LampMask LampSet::open(const TraceScene& scene, const Extent* extent, const Vec3& origin,
                       LampMask wanted) const {
  if (scene.empty()) return wanted;
  LampMask blocked = 0;
  for (std::size_t l = 0; l < lamps_.size(); ++l) {
    const auto bits = static_cast<std::uint16_t>(wanted >> (16 * l));
    if (bits == 0) continue;
    const Lamp& lamp = lamps_[l];
    if (extent != nullptr && !can_hit(*extent, origin, lamp.centre, lamp.half_x, lamp.half_y))
      continue;
    blocked |= static_cast<LampMask>(scene.blocked16(origin, lamp.samples.data(), bits))
               << (16 * l);
  }
  return wanted & ~blocked;
}

LampMask LampSet::open_middle(const TraceScene& scene, const Vec3& origin, LampMask wanted) const {
  for (std::size_t l = 0; l < lamps_.size(); ++l) {
    const LampMask bits = LampMask{0xFFFF} << (16 * l);
    if ((wanted & bits) != 0 && scene.blocked(origin, lamps_[l].centre)) wanted &= ~bits;
  }
  return wanted;
}

float LampSet::irradiance(const Vec3& position, const Vec3& normal, LampMask open) const {
  float sum = 0;
  for (std::size_t l = 0; l < lamps_.size(); ++l) {
    const auto bits = static_cast<std::uint32_t>((open >> (16 * l)) & 0xFFFFU);
    if (bits == 0) continue;
    const Lamp& lamp = lamps_[l];
    Lane term;
    for (int s = 0; s < kLampSamples; ++s) {
      const float x = lamp.x[s] - position.x(), y = lamp.y[s] - position.y(),
                  z = lamp.z[s] - position.z();
      const float d2 = x * x + y * y + z * z;
      const float receiver = std::max(0.0F, x * normal.x() + y * normal.y() + z * normal.z());
      const float emitter = std::max(
          0.0F, -(x * lamp.direction.x() + y * lamp.direction.y() + z * lamp.direction.z()));
      // cos cos / d^2; both cosines are not yet divided by d.
      term[s] = static_cast<float>((bits >> s) & 1U) * receiver * emitter / (d2 * d2);
    }
    float lamp_sum = 0;
    for (const float t : term) lamp_sum += t;
    sum += lamp.strength * lamp_sum / kLampSamples;
  }
  return sum;
}

}  // namespace mixrig::studio

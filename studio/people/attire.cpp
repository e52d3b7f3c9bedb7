// SPDX-License-Identifier: Apache-2.0
// Clothes of a person, and carried things, in addition to the plain body.
#include "studio/people/attire.h"

#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "studio/sensors/noise.h"

namespace mixrig::studio {

void add_strands(const Build& build, const BodyPoints& points, unsigned seed, Mesh& mesh) {
  constexpr std::uint64_t kStrands = 700;
  constexpr float kWide_m = 1.5e-3F;
  const float k = build.scale;
  const Vec3 middle = points.chin + k * (0.15F * points.up - 0.012F * points.ahead);
  for (std::uint64_t i = 0; i < kStrands; ++i) {
    const std::uint64_t key = hash_key(seed, 0x4A12, i);
    const auto random = [key](std::uint64_t n) { return uniform(hash_key(key, n)); };
    // Directions from the middle of the head, without the face.
    const float up = -0.35F + 1.35F * random(1), angle = 2 * std::numbers::pi_v<float> * random(2);
    const float flat = std::sqrt(std::max(0.0F, 1 - up * up));
    const float ahead = flat * std::cos(angle), left = flat * std::sin(angle);
    if (ahead > 0.25F + 0.5F * up) continue;
    const Vec3 out = ahead * points.ahead + left * points.left + up * points.up;
    const Vec3 root = middle + k * (0.100F * ahead * points.ahead + 0.077F * left * points.left +
                                    0.095F * up * points.up);
    const Vec3 lean(random(3) - 0.5F, random(4) - 0.5F, random(5) - 0.7F);
    const Vec3 way = (out + 0.9F * lean).normalized();
    const float length = k * (0.02F + 0.03F * random(6));
    const Vec3 across = 0.5F * kWide_m * way.cross(lean + Vec3(0.3F, 0.2F, 0.1F)).normalized();
    const Material hair{Kind::kStrand, static_cast<std::uint8_t>(i % 4)};
    const Vec3 half = root + 0.6F * length * way;
    const Vec3 tip = half + 0.4F * length * (way + Vec3(0, 0, -0.7F)).normalized();
    add_flat(mesh, root - across, root + across, half + across, hair);
    add_flat(mesh, root - across, half + across, half - across, hair);
    add_flat(mesh, half - across, half + across, tip, hair);
  }
}

void add_coat(const Build& build, const Posture& p, const BodyPoints& points, Mesh& mesh) {
  struct Cut {
    float high, wide, deep;
  };
  constexpr std::array<Cut, 7> kCuts{{{0.44F, 0.190F, 0.125F},
                                      {0.30F, 0.180F, 0.128F},
                                      {0.15F, 0.178F, 0.130F},
                                      {0.00F, 0.205F, 0.150F},
                                      {-0.15F, 0.235F, 0.180F},
                                      {-0.30F, 0.260F, 0.205F},
                                      {-0.40F, 0.275F, 0.220F}}};
  const float k = build.scale;
  const Vec3 ahead(std::cos(p.yaw_rad), std::sin(p.yaw_rad), 0), left(-ahead.y(), ahead.x(), 0);
  std::array<Ring, kCuts.size()> rings;
  for (std::size_t i = 0; i < kCuts.size(); ++i) {
    const Cut& cut = kCuts[i];
    const float below = std::max(0.0F, 0.1F - cut.high), above = std::max(0.0F, cut.high);
    const Vec3 sway = below * p.twist_rad * (1.2F * left - 0.8F * ahead);
    const float fold = 1 + 0.10F * below * std::sin(40 * cut.high + 20 * p.twist_rad);
    const float g = k * build.girth * fold;
    const Vec3 up = above > 0 ? points.chest_up : Vec3(Vec3::UnitZ());
    rings[i] = {p.pelvis + cut.high * k * up + sway, -cut.deep * g * ahead, -cut.wide * g * left,
                -cut.high};
  }
  add_loft(mesh, rings, 32, {Kind::kShirt, 4});
}

void add_props(const Posture& p, const BodyPoints& points, Mesh& mesh) {
  const Vec3 ahead(std::cos(p.yaw_rad), std::sin(p.yaw_rad), 0);
  const Vec3 along = (Vec3(0, 0, 1) + 0.35F * ahead).normalized();
  add_limb(mesh, points.hands[0] - 0.55F * along, points.hands[0] + 0.75F * along, 0.006F, 0.006F,
           10, {Kind::kStick});
  const Vec3 bag = points.hands[1] - Vec3(0, 0, 0.33F);
  add_box(mesh, bag, {0.28F, 0.10F, 0.24F}, p.yaw_rad, {Kind::kBlack});
  add_limb(mesh, bag + Vec3(0, 0, 0.24F), points.hands[1], 0.008F, 0.008F, 8, {Kind::kBlack});
  const Vec3 ball = points.hands[1] + 0.09F * ahead;
  add_ellipsoid(mesh, ball, {0.05F, 0, 0}, {0, 0.05F, 0}, {0, 0, 0.05F}, 28, {Kind::kChrome});
}

}  // namespace mixrig::studio

// SPDX-License-Identifier: Apache-2.0
// The person's body and clothes in a posture.
#include "studio/stage/person.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "hal/base/angles.h"
#include "studio/sensors/noise.h"

namespace mixrig::studio {
namespace {

using Turn = Eigen::AngleAxisf;

/// Axes of a body part: forward, left, up.
struct Axes {
  Vec3 ahead, left, up;
};
Axes turned(const Axes& axes, const Eigen::Quaternionf& by) {
  return {by * axes.ahead, by * axes.left, by * axes.up};
}

/// Radius of a bent limb at a position: 0 is its root, 1 the joint, 2 its end.
struct Girth {
  float at, radius_m;
};

float girth_at(std::span<const Girth> profile, float s) {
  for (std::size_t i = 1; i < profile.size(); ++i)
    if (s <= profile[i].at) {
      const float t = (s - profile[i - 1].at) / (profile[i].at - profile[i - 1].at);
      return std::lerp(profile[i - 1].radius_m, profile[i].radius_m, t * t * (3 - 2 * t));
    }
  return profile.back().radius_m;
}

/// A limb along a - b - c, rounded at the joint b. `folds` is the relative depth of folds in cloth.
void add_bent_limb(Mesh& mesh, const std::array<Vec3, 3>& joints, const Vec3& front,
                   std::span<const Girth> profile, float folds, Material material) {
  constexpr int kRings = 30, kSegments = 18;
  const auto& [a, b, c] = joints;
  const Vec3 upper = (b - a).normalized(), lower = (c - b).normalized();
  const float from = profile.front().at, to = profile.back().at;
  std::array<Ring, kRings> rings;
  for (int i = 0; i < kRings; ++i) {
    const float s = std::lerp(from, to, static_cast<float>(i) / (kRings - 1));
    const float bend = std::clamp((s - 0.8F) / 0.4F, 0.0F, 1.0F);
    const Vec3 axis = (upper + bend * (lower - upper)).normalized();
    Vec3 centre = s < 1 ? Vec3(a + s * (b - a)) : Vec3(b + (s - 1) * (c - b));
    // Near the joint the centre line is moved to the inside of the bend.
    const float near = std::max(0.0F, 1 - std::abs(s - 1) / 0.2F);
    centre += 0.02F * near * near * (lower - upper);
    const Vec3 x = (front - front.dot(axis) * axis).normalized(), y = axis.cross(x);
    float r = girth_at(profile, s);
    r *= 1 + folds * (value_noise({9 * s, 0.3F}, material.variant) - 0.5F) +
         folds * near * std::sin(30 * s);
    const float end = i == 0 || i == kRings - 1 ? 0.55F : 1.0F;
    rings[static_cast<std::size_t>(i)] = {centre, end * r * x, end * r * y, s * 0.4F};
  }
  add_loft(mesh, rings, kSegments, material);
}

/// The middle joint of a two-bone chain that bends towards `pole`.
Vec3 middle_joint(const Vec3& root, const Vec3& end, float upper_m, float lower_m,
                  const Vec3& pole) {
  const Vec3 span = end - root;
  const float d =
      std::clamp(span.norm(), std::abs(upper_m - lower_m) + 1e-3F, upper_m + lower_m - 1e-3F);
  const Vec3 axis = span.normalized();
  const float along = (upper_m * upper_m - lower_m * lower_m + d * d) / (2 * d);
  const float off = std::sqrt(std::max(0.0F, upper_m * upper_m - along * along));
  return root + along * axis + off * (pole - pole.dot(axis) * axis).normalized();
}

void add_foot(Mesh& mesh, const Vec3& ankle, float yaw, float pitch, float k) {
  const Vec3 flat(std::cos(yaw), std::sin(yaw), 0), left(-std::sin(yaw), std::cos(yaw), 0);
  const Turn tilt(pitch, left);
  const Vec3 ahead = tilt * flat, up = ahead.cross(left);
  struct Cut {
    float along, wide, high;
  };
  constexpr std::array<Cut, 8> kCuts{{{-0.075F, 0.02F, 0.03F},
                                      {-0.065F, 0.034F, 0.055F},
                                      {-0.02F, 0.038F, 0.085F},
                                      {0.04F, 0.042F, 0.07F},
                                      {0.10F, 0.048F, 0.05F},
                                      {0.15F, 0.048F, 0.042F},
                                      {0.185F, 0.038F, 0.034F},
                                      {0.20F, 0.012F, 0.02F}}};
  std::array<Ring, kCuts.size()> rings;
  for (std::size_t i = 0; i < kCuts.size(); ++i) {
    const Vec3 centre = ankle + k * (kCuts[i].along * ahead + (kCuts[i].high / 2 - 0.075F) * up);
    rings[i] = {centre, k * kCuts[i].wide * left, k * kCuts[i].high / 2 * up, kCuts[i].along};
  }
  add_loft(mesh, rings, 16, {Kind::kShoe});
}

void add_leg(Mesh& mesh, const Build& build, const Posture& p, int side) {
  const float k = build.scale, g = build.girth * k;
  const Vec3 ahead(std::cos(p.yaw_rad), std::sin(p.yaw_rad), 0);
  const Vec3 left(-ahead.y(), ahead.x(), 0);
  const Vec3 hip = p.pelvis + (side == 0 ? 0.088F : -0.088F) * k * left;
  const Vec3 knee =
      middle_joint(hip, p.ankles[side], 0.43F * k, 0.425F * k, ahead + Vec3(0, 0, 0.2F));
  const std::array<Girth, 6> trousers{{{-0.08F, 0.092F * g},
                                       {0.3F, 0.086F * g},
                                       {0.95F, 0.062F * g},
                                       {1.3F, 0.064F * g},
                                       {1.7F, 0.056F * g},
                                       {1.97F, 0.062F * g}}};
  add_bent_limb(mesh, {hip, knee, p.ankles[side]}, ahead, trousers, 0.10F,
                {Kind::kTrousers, static_cast<std::uint8_t>(1 + side)});
  add_foot(mesh, p.ankles[side], p.foot_yaw_rad[side], p.foot_pitch_rad[side], k);
}

/// A palm and five fingers of two bones each. `palm` is the palm's normal.
void add_hand(Mesh& mesh, const Vec3& wrist, const Vec3& along, const Vec3& palm, float thumb_side,
              const Posture& p, float k) {
  const Vec3 across = thumb_side * along.cross(palm);
  const std::array<Ring, 4> rings{
      Ring{wrist - 0.01F * k * along, 0.024F * k * across, 0.018F * k * palm, 0},
      Ring{wrist + 0.03F * k * along, 0.034F * k * across, 0.017F * k * palm, 0.03F},
      Ring{wrist + 0.075F * k * along, 0.041F * k * across, 0.014F * k * palm, 0.07F},
      Ring{wrist + 0.092F * k * along, 0.036F * k * across, 0.010F * k * palm, 0.09F}};
  // The half axes and `along` must form a right-handed frame for both hands.
  std::array<Ring, 4> hand = rings;
  if (thumb_side > 0)
    for (Ring& r : hand) r.half_y = -r.half_y;
  add_loft(mesh, hand, 14, {Kind::kSkin});
  for (int f = 0; f < 5; ++f) {
    const bool thumb = f == 4;
    const float place = thumb ? 1.0F : 0.75F - 0.5F * static_cast<float>(f);
    const float length = k * (thumb ? 0.030F : f == 3 ? 0.030F : f == 1 ? 0.042F : 0.038F);
    const float fan = thumb ? 0.8F : 0.35F * p.finger_spread * place;
    Vec3 way = (along + fan * across + 0.25F * p.finger_curl * palm).normalized();
    const Vec3 root = wrist + k * (thumb ? 0.03F : 0.088F) * along + 0.034F * k * place * across;
    const Vec3 middle = root + length * 1.1F * way;
    way = (way + 1.1F * p.finger_curl * palm).normalized();
    const float r = k * (thumb ? 0.0105F : 0.0088F);
    add_limb(mesh, root, middle, r, 0.92F * r, 8, {Kind::kSkin});
    add_limb(mesh, middle, middle + length * way, 0.92F * r, 0.75F * r, 8, {Kind::kSkin});
  }
}

Vec3 add_arm(Mesh& mesh, const Build& build, const Posture& p, const Axes& chest, int side) {
  const float k = build.scale, g = (0.6F + 0.4F * build.girth) * k, out = side == 0 ? 1.0F : -1.0F;
  const ArmAngles& angles = p.arms[static_cast<std::size_t>(side)];
  const Vec3 neck = p.pelvis + 0.50F * k * chest.up;
  const Vec3 shoulder = neck + out * 0.178F * k * chest.left;
  // Spread about the forward axis, then swing about the left axis.
  const Eigen::Quaternionf swing(Turn(-angles.swing_rad, chest.left));
  const Eigen::Quaternionf spread(Turn(out * angles.spread_rad, chest.ahead));
  const Axes upper = turned(chest, swing * spread);
  const Vec3 elbow = shoulder - 0.285F * k * upper.up;
  const Eigen::Quaternionf bend(Turn(-angles.bend_rad, upper.left));
  const Eigen::Quaternionf inward(Turn(-out * angles.inward_rad, upper.up));
  const Axes lower = turned(upper, inward * bend);
  const Vec3 wrist = elbow - 0.255F * k * lower.up;
  const std::array<Girth, 5> skin{{{0, 0.045F * g},
                                   {0.9F, 0.038F * g},
                                   {1.25F, 0.040F * g},
                                   {1.7F, 0.030F * g},
                                   {2.02F, 0.024F * g}}};
  add_bent_limb(mesh, {shoulder, elbow, wrist}, chest.ahead, skin, 0, {Kind::kSkin});
  const float cuff = build.long_sleeves ? 1.93F : 0.62F;
  // The sleeve ends in a dome at the shoulder, so that no edge protrudes from the shirt.
  const std::array<Girth, 6> sleeve{{{-0.17F, 0.012F * g},
                                     {-0.13F, 0.034F * g},
                                     {0.02F, 0.054F * g},
                                     {0.3F * cuff, 0.055F * g},
                                     {0.7F * cuff, 0.049F * g},
                                     {cuff, (build.long_sleeves ? 0.036F : 0.056F) * g}}};
  add_bent_limb(mesh, {shoulder, elbow, wrist}, chest.ahead, sleeve, 0.12F,
                {Kind::kShirt, static_cast<std::uint8_t>(1 + side)});
  // The palm of a hanging hand faces the thigh.
  add_hand(mesh, wrist, -lower.up, -out * lower.left, 1, p, k);
  return wrist - 0.06F * k * lower.up - 0.02F * out * k * lower.left;
}

void add_torso(Mesh& mesh, const Build& build, const Posture& p, const Axes& hips,
               const Axes& chest) {
  const float k = build.scale, g = build.girth;
  struct Cut {
    float high, wide, deep;
  };
  constexpr std::array<Cut, 14> kCuts{{{-0.11F, 0.085F, 0.06F},
                                       {-0.09F, 0.145F, 0.105F},
                                       {0.0F, 0.168F, 0.118F},
                                       {0.08F, 0.158F, 0.110F},
                                       {0.17F, 0.146F, 0.102F},
                                       {0.25F, 0.152F, 0.106F},
                                       {0.34F, 0.168F, 0.114F},
                                       {0.42F, 0.180F, 0.112F},
                                       {0.48F, 0.186F, 0.098F},
                                       {0.525F, 0.178F, 0.080F},
                                       {0.548F, 0.135F, 0.070F},
                                       {0.568F, 0.085F, 0.062F},
                                       {0.585F, 0.062F, 0.058F},
                                       {0.595F, 0.054F, 0.052F}}};
  const auto ring = [&](const Cut& cut) {
    const float t = std::clamp(cut.high / 0.5F, 0.0F, 1.0F);
    const Vec3 ahead = (hips.ahead + t * (chest.ahead - hips.ahead)).normalized();
    const Vec3 up = (hips.up + t * (chest.up - hips.up)).normalized();
    const Vec3 left = up.cross(ahead).normalized();
    const float fat = cut.high < 0.45F ? g : 0.5F + 0.5F * g;
    const float fold =
        1 + 0.025F * std::sin(70 * cut.high + 1.3F) * (cut.high < 0.3F ? 1.0F : 0.3F);
    // The seam is at the back: u = 0.5 is the chest.
    return Ring{p.pelvis + cut.high * k * up, -cut.deep * k * fat * fold * ahead,
                -cut.wide * k * fat * fold * left, cut.high};
  };
  std::vector<Ring> rings;
  for (std::size_t i = 0; i < 4; ++i) rings.push_back(ring(kCuts[i]));
  add_loft(mesh, rings, 32, {Kind::kTrousers, 3});
  rings.clear();
  // The shirt covers the belt.
  Cut hem = kCuts[2];
  hem.high = -0.015F, hem.wide += 0.012F, hem.deep += 0.012F;
  rings.push_back(ring(hem));
  for (std::size_t i = 3; i < kCuts.size(); ++i) {
    Cut cut = kCuts[i];
    if (i < 5) cut.wide += 0.010F, cut.deep += 0.010F;
    rings.push_back(ring(cut));
  }
  add_loft(mesh, rings, 32, {Kind::kShirt, 0});
}

void add_head(Mesh& mesh, const Build& build, const Posture& p, const Axes& chest,
              BodyPoints& points) {
  const float k = build.scale;
  const Vec3 neck = p.pelvis + 0.56F * k * chest.up;
  const Axes head = turned(chest, Eigen::Quaternionf(Turn(p.head_yaw_rad, Vec3::UnitZ())) *
                                      Eigen::Quaternionf(Turn(p.head_nod_rad, chest.left)));
  const Vec3 chin = neck + k * (0.065F * head.up + 0.022F * head.ahead);
  points.chin = chin, points.ahead = head.ahead, points.left = head.left, points.up = head.up;
  add_limb(mesh, neck - 0.03F * k * chest.up, chin + 0.05F * k * head.up - 0.02F * k * head.ahead,
           0.056F * k, 0.052F * k, 20, {Kind::kSkin});
  struct Cut {
    float high, wide, deep, ahead;
  };
  constexpr std::array<Cut, 13> kCuts{{{0.0F, 0.012F, 0.018F, 0.055F},
                                       {0.008F, 0.032F, 0.045F, 0.034F},
                                       {0.035F, 0.050F, 0.068F, 0.016F},
                                       {0.065F, 0.062F, 0.084F, 0.004F},
                                       {0.095F, 0.069F, 0.094F, -0.004F},
                                       {0.120F, 0.073F, 0.098F, -0.006F},
                                       {0.150F, 0.076F, 0.101F, -0.008F},
                                       {0.175F, 0.075F, 0.099F, -0.009F},
                                       {0.198F, 0.069F, 0.091F, -0.010F},
                                       {0.216F, 0.057F, 0.075F, -0.011F},
                                       {0.229F, 0.040F, 0.053F, -0.012F},
                                       {0.236F, 0.022F, 0.029F, -0.012F},
                                       {0.2385F, 0.006F, 0.008F, -0.012F}}};
  std::vector<Ring> rings, hair;
  for (const Cut& cut : kCuts) {
    const float v = cut.high / 0.2385F;
    const Vec3 centre = chin + k * (cut.high * head.up + cut.ahead * head.ahead);
    rings.push_back({centre, -cut.deep * k * head.ahead, -cut.wide * k * head.left, v});
    if (cut.high < 0.06F) continue;
    // Hair is moved back, so that it does not cover the face.
    const float more = cut.high > 0.17F ? 0.011F : 0.006F;
    const float back = cut.high > 0.19F ? -0.004F : cut.high > 0.14F ? -0.020F : -0.034F;
    hair.push_back({centre + k * (back * head.ahead + 0.35F * more * head.up),
                    -(cut.deep + more + 0.4F * back) * k * head.ahead,
                    -(cut.wide + more * 0.7F) * k * head.left, v});
  }
  add_loft(mesh, rings, 36, {Kind::kFace});
  add_loft(mesh, hair, 32, {Kind::kHair});
  const Vec3 nose = chin + k * (0.098F * head.up + 0.094F * head.ahead);
  add_ellipsoid(mesh, nose, 0.014F * k * head.left, -0.018F * k * head.ahead, 0.026F * k * head.up,
                12, {Kind::kSkin});
  for (const float out : {-1.0F, 1.0F})
    add_ellipsoid(
        mesh, chin + k * (0.115F * head.up + out * 0.075F * head.left - 0.012F * head.ahead),
        0.010F * k * head.left, -0.020F * k * head.ahead, 0.032F * k * head.up, 12, {Kind::kSkin});
}

}  // namespace

BodyPoints build_person(const Build& build, const Posture& p, Mesh& mesh) {
  const Axes world{Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  const Axes hips = turned(world, Eigen::Quaternionf(Turn(p.yaw_rad, Vec3::UnitZ())));
  const Axes chest = turned(hips, Eigen::Quaternionf(Turn(p.twist_rad, Vec3::UnitZ())) *
                                      Eigen::Quaternionf(Turn(p.lean_rad, hips.left)));
  BodyPoints points;
  for (int side = 0; side < 2; ++side) {
    add_leg(mesh, build, p, side);
    points.hands[static_cast<std::size_t>(side)] = add_arm(mesh, build, p, chest, side);
  }
  add_torso(mesh, build, p, hips, chest);
  add_head(mesh, build, p, chest, points);
  points.chest_ahead = chest.ahead, points.chest_up = chest.up;
  return points;
}

}  // namespace mixrig::studio

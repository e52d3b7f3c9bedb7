// SPDX-License-Identifier: Apache-2.0
// The person's motion.
#include "studio/stage/posture.h"

#include <algorithm>
#include <cmath>

#include "hal/base/angles.h"
#include "studio/sensors/noise.h"
#include "studio/stage/room.h"

namespace mixrig::studio {
namespace {

constexpr int kPathSteps = 720;
constexpr double kStance = 0.6;     ///< share of the gait cycle in which a foot is on the floor
constexpr float kAnkle_m = 0.075F;  ///< height of the ankle of a standing foot at scale 1
constexpr float kLeg_m = 0.845F;    ///< hip to ankle, stretched, at scale 1

Vec3 facing(float yaw) { return {std::cos(yaw), std::sin(yaw), 0}; }
Vec3 left_of(float yaw) { return {-std::sin(yaw), std::cos(yaw), 0}; }
float ease(float t) { return t * t * (3 - 2 * t); }

/// Moves an ankle into the leg's reach, raises the heel for it, and keeps toes and heel above the
/// floor.
void reach(const Vec3& hip, float leg_m, float scale, Vec3& ankle, float& pitch) {
  const Vec3 leg = ankle - hip;
  const float missing = leg.norm() - leg_m;
  if (missing > 0) {
    ankle = hip + leg.normalized() * leg_m;
    pitch += 4.0F * missing;
  }
  constexpr float kToe_m = 0.19F, kHeel_m = 0.07F;
  const float below = kAnkle_m * std::cos(pitch) +
                      (pitch > 0 ? kToe_m * std::sin(pitch) : -kHeel_m * std::sin(pitch));
  ankle.z() = std::max(ankle.z(), scale * below);
}

}  // namespace

PersonMotion::PersonMotion(Scenario scenario, unsigned seed, const Stage& stage, double start_s)
    : scenario_(scenario), seed_(seed), stage_(stage), start_s_(start_s) {
  const std::uint64_t key = hash_key(seed, 0xB0D4);
  build_.scale = 0.93F + 0.14F * uniform(key + 1);
  build_.girth = 0.92F + 0.25F * uniform(key + 2);
  build_.long_sleeves = uniform(key + 3) < 0.6F;
  seated_ = scenario == Scenario::kStill || (scenario == Scenario::kTalk && seed % 2 == 0);
  speed_m_s_ = 0.95 + 0.35 * uniform(key + 4);
  stride_m_ = (1.05 + 0.15 * uniform(key + 5)) * build_.scale;
  turn_ = uniform(key + 6) < 0.5F ? 1 : -1;
  arc_m_.resize(kPathSteps + 1, 0);
  for (int i = 1; i <= kPathSteps; ++i) {
    const double angle = 2 * kPi * (i - 0.5) / kPathSteps;
    arc_m_[static_cast<std::size_t>(i)] = arc_m_[static_cast<std::size_t>(i - 1)] +
                                          2 * kPi / kPathSteps *
                                              std::hypot(stage.path_half_m.x() * std::sin(angle),
                                                         stage.path_half_m.y() * std::cos(angle));
  }
  // The person first passes the object 0.8 s after the start; the seed decides whether in front of
  // it or behind it.
  const bool behind = uniform(key + 7) < 0.5F;
  start_m_ = (behind ? 0.0 : 0.5) * arc_m_.back() - 0.8 * speed_m_s_;
  if (scenario == Scenario::kRounds) turn_ = -1, start_m_ = 0;
}

PersonMotion::OnPath PersonMotion::on_path(double distance_m) const {
  return scenario_ == Scenario::kRounds ? on_rounds(distance_m) : on_lap(distance_m);
}

/// Place on the way of scenario rounds: in, two and a half laps, a turn on the spot, half a lap
/// back, and out where it came in.
PersonMotion::OnPath PersonMotion::on_rounds(double distance_m) const {
  constexpr double kTurn_m = 1.0;  // of steps on the spot
  const double lap = arc_m_.back(), in_m = stage_.way_in_m;
  const double there_m = in_m + 2.5 * lap, back_m = in_m + 0.5 * lap;
  const double gone_m = std::clamp(distance_m, 0.0, there_m + kTurn_m + back_m);
  const auto at = [&](double m) {  // from where the path begins
    OnPath p = on_lap(0.5 * lap + std::max(0.0, m));
    if (m < 0) p.position += static_cast<float>(m) * facing(p.heading_rad);
    return p;
  };
  if (gone_m < there_m) return at(gone_m - in_m);
  const double turned = std::min(1.0, (gone_m - there_m) / kTurn_m);
  const double returned_m = std::max(0.0, gone_m - there_m - kTurn_m);
  OnPath p = at(0.5 * lap - returned_m);
  p.heading_rad += static_cast<float>(kPi * turned);
  return p;
}

PersonMotion::OnPath PersonMotion::on_lap(double distance_m) const {
  const double lap = arc_m_.back();
  const double s = distance_m - lap * std::floor(distance_m / lap);
  const auto after = std::upper_bound(arc_m_.begin(), arc_m_.end() - 1, s);
  const double low = after[-1], high = std::max(*after, low + 1e-9);
  const double step = static_cast<double>(after - arc_m_.begin()) - 1 + (s - low) / (high - low);
  const double angle = turn_ * 2 * kPi * step / kPathSteps;
  const double a = stage_.path_half_m.x(), b = stage_.path_half_m.y();
  return {
      Vec3(static_cast<float>(stage_.object.x() + a * std::cos(angle)),
           static_cast<float>(stage_.object.y() + b * std::sin(angle)), 0),
      static_cast<float>(std::atan2(turn_ * b * std::cos(angle), -turn_ * a * std::sin(angle)))};
}

double PersonMotion::time_towards(double x, double y) const {
  const double angle =
      turn_ * std::atan2(y / stage_.path_half_m.y(), x / stage_.path_half_m.x()) / (2 * kPi);
  const double step = (angle - std::floor(angle)) * kPathSteps;
  const auto low = std::min(static_cast<std::size_t>(step), arc_m_.size() - 2);
  const double along_m =
      arc_m_[low] + (step - static_cast<double>(low)) * (arc_m_[low + 1] - arc_m_[low]);
  return start_s_ + (along_m - start_m_) / speed_m_s_;
}

Posture PersonMotion::at(double time_s) const { return walks() ? walk(time_s) : stay(time_s); }

bool PersonMotion::walks() const {
  return !seated_ && scenario_ != Scenario::kTalk && scenario_ != Scenario::kEdges;
}

/// Each foot stands still for kStance of the cycle, then swings to its next position.
void PersonMotion::plant_feet(double walked_m, Posture& posture) const {
  const float k = build_.scale;
  for (int side = 0; side < 2; ++side) {
    const double cycle = walked_m / stride_m_ + 0.5 * side;
    const double begun = std::floor(cycle), phase = cycle - begun;
    const double stand_m = (begun - 0.5 * side + kStance / 2) * stride_m_;
    const float t = phase < kStance ? 0.0F : static_cast<float>((phase - kStance) / (1 - kStance));
    const OnPath foot = on_path(start_m_ + stand_m + ease(t) * stride_m_);
    const float out = (side == 0 ? 0.075F : -0.075F) * k;
    const float lift = 0.10F * k * std::sin(kPi_f * t);
    posture.ankles[side] =
        foot.position + out * left_of(foot.heading_rad) + Vec3(0, 0, kAnkle_m * k + lift);
    posture.foot_yaw_rad[side] = foot.heading_rad + (side == 0 ? 0.1F : -0.1F);
    // Toes point down early in the swing and up at the next heel strike.
    posture.foot_pitch_rad[side] = t > 0 ? 0.55F * std::cos(kPi_f * t) * (1 - t * t) : 0.0F;
    const Vec3 hip = posture.pelvis + (side == 0 ? 0.09F : -0.09F) * k * left_of(posture.yaw_rad);
    reach(hip, kLeg_m * k, k, posture.ankles[side], posture.foot_pitch_rad[side]);
  }
}

Posture PersonMotion::walk(double time_s) const {
  const double walked_m = speed_m_s_ * (time_s - start_s_);
  const OnPath here = on_path(start_m_ + walked_m);
  const float k = build_.scale, phase = static_cast<float>(2 * kPi * walked_m / stride_m_);
  const auto t = static_cast<float>(time_s);
  Posture p;
  p.yaw_rad = here.heading_rad;
  p.pelvis = here.position + Vec3(0, 0, (0.893F - 0.014F * std::cos(2 * phase)) * k) +
             0.02F * std::sin(phase) * left_of(p.yaw_rad);
  p.lean_rad = 0.05F;
  p.twist_rad = 0.12F * std::cos(phase);
  for (int side = 0; side < 2; ++side) {
    const float swing = (side == 0 ? -1.0F : 1.0F) * std::cos(phase);
    p.arms[side] = {0.05F + 0.38F * swing, 0.13F, 0.35F + 0.22F * std::max(0.0F, swing), 0.25F};
  }
  p.head_yaw_rad = 0.35F * wander(0.4F * t, seed_ + 11);
  p.head_nod_rad = 0.08F * wander(0.7F * t, seed_ + 12);
  plant_feet(walked_m, p);
  return p;
}

/// Gestures while talking: both arms move randomly between resting and raised.
void PersonMotion::gesture(float t, Posture& p) const {
  const float lively = scenario_ == Scenario::kTalk ? 1.0F : 0.15F;
  for (int side = 0; side < 2; ++side) {
    const auto salt = seed_ + 40 + 10 * static_cast<unsigned>(side);
    const float raise = lively * std::clamp(0.55F + 0.8F * wander(0.8F * t, salt), 0.0F, 1.0F);
    const float rest = seated_ ? 0.35F : 0.05F;
    ArmAngles& arm = p.arms[side];
    arm.swing_rad = rest + 0.55F * raise + 0.1F * lively * wander(2.2F * t, salt + 1);
    arm.spread_rad = 0.14F + 0.22F * raise;
    arm.bend_rad =
        (seated_ ? 0.95F : 0.25F) + 0.9F * raise + 0.35F * lively * wander(1.9F * t, salt + 2);
    arm.inward_rad = 0.35F + 0.5F * lively * wander(1.3F * t, salt + 3);
  }
  p.finger_curl = 0.4F + 0.25F * lively * wander(1.1F * t, seed_ + 70);
  p.head_yaw_rad = 0.30F * wander(0.55F * t, seed_ + 71);
  p.head_nod_rad = 0.12F * lively * wander(1.8F * t, seed_ + 72) + 0.03F;
}

Posture PersonMotion::stay(double time_s) const {
  const auto t = static_cast<float>(time_s);
  const float k = build_.scale;
  Posture p;
  // Faces the camera, which looks along world x, and is turned slightly to the object.
  p.yaw_rad = kPi_f - 0.35F + 0.06F * wander(0.3F * t, seed_ + 80);
  const Vec3 spot(stage_.spot.x(), stage_.spot.y(), 0);
  const Vec3 ahead = facing(p.yaw_rad), left = left_of(p.yaw_rad);
  const float sway = 0.015F * wander(0.5F * t, seed_ + 81);
  p.pelvis =
      spot + Vec3(0, 0, seated_ ? kSeatHeight_m + 0.105F * build_.girth : 0.905F * k) + sway * left;
  if (seated_) p.pelvis -= 0.04F * ahead;
  p.lean_rad = (seated_ ? -0.06F : 0.02F) + 0.05F * wander(0.6F * t, seed_ + 82);
  p.twist_rad = 0.10F * wander(0.45F * t, seed_ + 83);
  for (int side = 0; side < 2; ++side) {
    const float out = side == 0 ? 1.0F : -1.0F;
    p.ankles[side] = spot + out * (seated_ ? 0.13F : 0.11F) * k * left +
                     (seated_ ? 0.40F * k : 0.02F * out) * ahead + Vec3(0, 0, kAnkle_m * k);
    p.foot_yaw_rad[side] = p.yaw_rad + 0.18F * out;
  }
  gesture(t, p);
  if (scenario_ == Scenario::kEdges) {
    for (int side = 0; side < 2; ++side)
      p.arms[side] = {0.35F + 0.35F * wander(0.7F * t, seed_ + 90 + side), 1.15F, 0.35F, 0.1F};
    p.finger_spread = 0.9F, p.finger_curl = 0.05F;
  }
  return p;
}

}  // namespace mixrig::studio

// SPDX-License-Identifier: Apache-2.0
// The board in the hands of a person who takes it from view to view.
#include "studio/board/board_hand.h"

#include <array>
#include <cmath>
#include <numbers>

#include "studio/board/board_poses.h"
#include "studio/sensors/noise.h"

namespace mixrig::studio {
namespace {

constexpr double kTurn_per_m = 3;                    ///< radians of tremor for each metre of it
constexpr double kSlowest_hz = 5, kFastest_hz = 11;  ///< physiological tremor of the hand
constexpr int kWaves = 3;

double between(std::uint64_t key, double low, double high) {
  return low + (high - low) * uniform(key);
}

/// Sum of waves of unit variance, swelling and ebbing every few seconds; `axis` 0..5.
double tremor(unsigned seed, int axis, double time_s) {
  const std::uint64_t key = hash_key(seed, 0x7E4403, static_cast<std::uint64_t>(axis));
  double sum = 0;
  for (int w = 0; w < kWaves; ++w) {
    const double hz = between(hash_key(key, 2 * w), kSlowest_hz, kFastest_hz);
    const double phase = between(hash_key(key, 2 * w + 1), 0, 2 * std::numbers::pi);
    sum += std::sqrt(2.0 / kWaves) * std::sin(2 * std::numbers::pi * hz * time_s + phase);
  }
  const double swell = std::sin(2 * std::numbers::pi * 0.35 * time_s + 1.7 * axis);
  return sum * (1 + 0.6 * swell) / std::sqrt(1.18);
}

/// Minimum jerk: rest to rest in unit time.
double eased(double s) { return s * s * s * (10 + s * (6 * s - 15)); }

}  // namespace

bool hand_rests(const HandMotion& hand, double time_s) {
  return std::fmod(time_s, hand.rest_s + hand.move_s) <= hand.rest_s;
}

geometry::Pose hand_pose(const BoardInfo& info, double time_s) {
  const HandMotion& hand = info.options.hand;
  const double period_s = hand.rest_s + hand.move_s;
  const int view = 1 + static_cast<int>(time_s / period_s);
  const double moved_s = std::fmod(time_s, period_s) - hand.rest_s;
  const BoardPlan& plan = info.options.board;
  const Eigen::Vector3d middle(0.5 * plan.width_m(), 0.5 * plan.height_m(), 0);
  geometry::Pose pose = board_place(info, view).target_from_board;
  Eigen::Vector3d centre = pose * middle;
  if (moved_s > 0) {
    const geometry::Pose next = board_place(info, view + 1).target_from_board;
    const double s = eased(moved_s / hand.move_s);
    centre += s * (next * middle - centre);
    pose.rotation = pose.rotation.slerp(s, next.rotation);
  }
  Eigen::Vector3d turn;
  for (int i = 0; i < 3; ++i) {
    centre[i] += hand.tremor_m * tremor(info.options.seed, i, time_s);
    turn[i] = kTurn_per_m * hand.tremor_m * tremor(info.options.seed, 3 + i, time_s);
  }
  if (const double angle = turn.norm(); angle > 0)
    pose.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle)) * pose.rotation;
  return {pose.rotation.normalized(), centre - pose.rotation.normalized() * middle};
}

}  // namespace mixrig::studio

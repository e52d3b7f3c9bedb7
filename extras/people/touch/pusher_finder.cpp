// SPDX-License-Identifier: Apache-2.0
#include "extras/people/touch/pusher_finder.h"

#include <algorithm>
#include <cmath>

namespace mixrig::touch {
namespace {

constexpr float kCell_m = 0.03F;  ///< of the surface of people
constexpr int kLeastPointsOfCell = 2;
constexpr float kFarthest_m = 0.3F;  ///< from a cell to that of the frame before
constexpr float kFastestPusher_m_s = 8;
constexpr double kLongestFrame_s = 0.1;  ///< between frames of which velocities are found

}  // namespace

std::span<const Pusher> PusherFinder::find(std::span<const Eigen::Vector3f> surface_m,
                                           const Eigen::Vector3d& eye_m, double time_s) {
  cells_.clear(), now_m_.clear(), pushers_.clear();
  for (const auto& p : surface_m) {
    const auto cell = [](float v) { return (std::lround(v / kCell_m) + 4096) & 0x1fff; };
    cells_.push_back({cell(p.x()) << 26 | cell(p.y()) << 13 | cell(p.z()), p, 1});
  }
  std::sort(cells_.begin(), cells_.end(), [](const Cell& a, const Cell& b) {
    if (a.key != b.key) return a.key < b.key;
    return std::lexicographical_compare(a.sum_m.data(), a.sum_m.data() + 3, b.sum_m.data(),
                                        b.sum_m.data() + 3);
  });
  for (std::size_t i = 0; i < cells_.size();) {
    Cell sum{cells_[i].key, Eigen::Vector3f::Zero(), 0};
    for (; i < cells_.size() && cells_[i].key == sum.key; ++i)
      sum.sum_m += cells_[i].sum_m, ++sum.count;
    if (sum.count >= kLeastPointsOfCell)
      now_m_.push_back(sum.sum_m / static_cast<float>(sum.count));
  }
  const double step_s = time_s - before_s_;
  const bool known = has_before_ && step_s > 0 && step_s <= kLongestFrame_s;
  for (const auto& p : now_m_) {
    Pusher pusher;
    // The seen point lies on the ball.
    pusher.at_m = p + Pusher::kRadius_m * (p - eye_m.cast<float>()).normalized();
    float least = kFarthest_m * kFarthest_m;
    for (std::size_t i = 0; known && i < before_m_.size(); ++i)
      if (const float d2 = (before_m_[i] - p).squaredNorm(); d2 < least)
        least = d2, pusher.velocity_m_s = (p - before_m_[i]) / static_cast<float>(step_s);
    if (pusher.velocity_m_s.norm() > kFastestPusher_m_s)
      pusher.velocity_m_s *= kFastestPusher_m_s / pusher.velocity_m_s.norm();
    pushers_.push_back(pusher);
  }
  before_m_ = now_m_;
  before_s_ = time_s, has_before_ = true;
  return pushers_;
}

}  // namespace mixrig::touch

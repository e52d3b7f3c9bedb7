// SPDX-License-Identifier: Apache-2.0
#include "host/pose/trajectory/trajectory.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "hal/base/order_statistics.h"
#include "host/math/estimation/verdict.h"

namespace mixrig::trajectory {
namespace {

using geometry::Pose;
constexpr double kGapSteps = 2.5;

bool is_sound(const TimedPose& sample) {
  const double norm = sample.world_from_body.rotation.norm();
  return std::isfinite(sample.t_s) && sample.world_from_body.translation_m.allFinite() &&
         std::isfinite(norm) && norm > 0.5 && norm < 2.0;
}

/// Returns the Lagrange weight at `t` of node `i` of `count`.
double lagrange(const std::array<double, 4>& nodes, std::size_t count, std::size_t i, double t) {
  double weight = 1.0;
  for (std::size_t j = 0; j < count; ++j)
    if (i != j) weight *= (t - nodes[j]) / (nodes[i] - nodes[j]);
  return weight;
}

}  // namespace

Trajectory::Trajectory(std::vector<TimedPose> samples) {
  // Equal times are sorted by index, so that the first one in the file counts.
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (is_sound(samples[i])) order.emplace_back(samples[i].t_s, i);
  std::sort(order.begin(), order.end());
  for (const auto& [t_s, index] : order) {
    if (!samples_.empty() && samples_.back().t_s == t_s) continue;
    samples_.push_back(samples[index]);
    samples_.back().world_from_body.rotation.normalize();
  }
  std::vector<double> steps;
  for (std::size_t i = 1; i < samples_.size(); ++i)
    steps.push_back(samples_[i].t_s - samples_[i - 1].t_s);
  median_step_s_ = upper_median_in_place(std::span(steps));
}

bool Trajectory::has_gap_after(std::size_t index) const {
  return samples_[index + 1].t_s - samples_[index].t_s > kGapSteps * median_step_s_;
}

std::optional<Pose> Trajectory::at(double t_s) const {
  if (samples_.empty() || !(t_s >= start_s()) || !(t_s <= end_s())) return std::nullopt;
  const auto above = std::upper_bound(samples_.begin(), samples_.end(), t_s,
                                      [](double t, const TimedPose& s) { return t < s.t_s; });
  const auto right = static_cast<std::size_t>(above - samples_.begin());
  const TimedPose& base = samples_[right - 1];
  if (base.t_s == t_s) return base.world_from_body;
  if (has_gap_after(right - 1)) return std::nullopt;
  std::size_t first = right - 1, last = right;
  if (first > 0 && !has_gap_after(first - 1) && last + 1 < samples_.size() && !has_gap_after(last))
    --first, ++last;
  std::array<double, 4> nodes{};
  const std::size_t count = last - first + 1;
  for (std::size_t k = 0; k < count; ++k) nodes[k] = samples_[first + k].t_s - base.t_s;
  Eigen::Vector3d turn = Eigen::Vector3d::Zero(), place = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < count; ++k) {
    const Pose& pose = samples_[first + k].world_from_body;
    const double weight = lagrange(nodes, count, k, t_s - base.t_s);
    turn += weight *
            estimation::rotation_log(base.world_from_body.rotation.conjugate() * pose.rotation);
    place += weight * (pose.translation_m - base.world_from_body.translation_m);
  }
  return Pose{base.world_from_body.rotation * estimation::rotation_exp(turn),
              base.world_from_body.translation_m + place};
}

}  // namespace mixrig::trajectory

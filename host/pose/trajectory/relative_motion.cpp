// SPDX-License-Identifier: Apache-2.0
#include "host/pose/trajectory/relative_motion.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace mixrig::trajectory {
namespace {

/// Ranks of rotation angles on a regular grid, scaled to mean 0 and spread 1; `known` is 0 or 1.
struct AngleSignal {
  double start_s = 0;
  std::vector<float> rank, known;
};

AngleSignal angle_signal(const Trajectory& trajectory, double window_s, double step_s) {
  AngleSignal signal;
  signal.start_s = trajectory.start_s();
  const auto count = static_cast<std::size_t>(
      std::max(0.0, (trajectory.end_s() - trajectory.start_s() - window_s) / step_s));
  signal.rank.assign(count, 0);
  signal.known.assign(count, 0);
  std::vector<std::pair<double, std::size_t>> angles;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = signal.start_s + static_cast<double>(i) * step_s;
    const auto motion = motion_over(trajectory, {t, t + window_s});
    if (motion) angles.emplace_back(motion->turn_rad.norm(), i);
  }
  std::sort(angles.begin(), angles.end());
  for (std::size_t r = 0; r < angles.size(); ++r) {
    const double share = (static_cast<double>(r) + 0.5) / static_cast<double>(angles.size());
    signal.rank[angles[r].second] = static_cast<float>((share - 0.5) * std::sqrt(12.0));
    signal.known[angles[r].second] = 1;
  }
  return signal;
}

/// Sums over the common known samples, with b's sample i paired with a's sample i + lag.
struct Common {
  double count = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
  double correlation() const {
    const double va = aa - a * a / count, vb = bb - b * b / count;
    return va > 0 && vb > 0 ? (ab - a * b / count) / std::sqrt(va * vb) : 0.0;
  }
};

Common compare(const AngleSignal& a, const AngleSignal& b, std::ptrdiff_t lag) {
  const auto first = std::max<std::ptrdiff_t>(0, -lag);
  const auto last = std::min<std::ptrdiff_t>(std::ssize(b.rank), std::ssize(a.rank) - lag);
  float count = 0, sa = 0, sb = 0, aa = 0, bb = 0, ab = 0;
  for (std::ptrdiff_t i = first; i < last; ++i) {
    // Unknown ranks are 0, so the products vanish by themselves.
    const float both = a.known[i + lag] * b.known[i];
    const float x = a.rank[i + lag] * both, y = b.rank[i] * both;
    count += both, sa += x, sb += y, aa += x * x, bb += y * y, ab += x * y;
  }
  return {count, sa, sb, aa, bb, ab};
}

}  // namespace

std::vector<Window> windows_of(const Trajectory& trajectory, double window_s) {
  std::vector<Window> windows;
  const auto& samples = trajectory.samples();
  const double slack_s = 0.5 * trajectory.median_step_s() + 1e-9;
  std::size_t ahead = 0;
  for (const TimedPose& sample : samples) {
    while (ahead < samples.size() && samples[ahead].t_s < sample.t_s + window_s - slack_s) ++ahead;
    if (ahead == samples.size()) break;
    if (samples[ahead].t_s <= sample.t_s + window_s + slack_s)
      windows.push_back({sample.t_s, samples[ahead].t_s});
  }
  return windows;
}

std::optional<Motion> motion_over(const Trajectory& trajectory, const Window& window) {
  const auto from = trajectory.at(window.from_s), to = trajectory.at(window.to_s);
  if (!from || !to) return std::nullopt;
  return Motion{estimation::rotation_log(from->rotation.conjugate() * to->rotation),
                from->rotation.conjugate() * (to->translation_m - from->translation_m)};
}

std::vector<OffsetCandidate> offset_candidates(const Trajectory& a, const Trajectory& b,
                                               const AlignOptions& options, int count) {
  constexpr double kMaxSamples = 8192;
  const double longest_s = std::max(a.end_s() - a.start_s(), b.end_s() - b.start_s());
  const double step_s = std::max(0.04, longest_s / kMaxSamples);
  const AngleSignal sa = angle_signal(a, options.window_s, step_s);
  const AngleSignal sb = angle_signal(b, options.window_s, step_s);
  const double fewest = std::max(options.min_overlap_s - options.window_s, 1.0) / step_s;

  struct Score {
    std::ptrdiff_t lag;
    double correlation, significance;
  };
  std::vector<Score> scores;
  for (std::ptrdiff_t lag = -std::ssize(sb.rank); lag < std::ssize(sa.rank); ++lag) {
    const Common common = compare(sa, sb, lag);
    if (common.count < fewest) continue;
    const double r = std::clamp(common.correlation(), -0.999, 0.999);
    // Fisher's z: a long overlap counts more than a short one that correlates by chance.
    scores.push_back({lag, r, std::atanh(r) * std::sqrt(common.count)});
  }
  std::sort(scores.begin(), scores.end(),
            [](const Score& x, const Score& y) { return x.significance > y.significance; });
  std::vector<OffsetCandidate> found;
  const double apart_s = options.window_s;
  for (const Score& score : scores) {
    if (std::ssize(found) >= count || score.correlation <= 0) break;
    const double offset_s = sa.start_s - sb.start_s + static_cast<double>(score.lag) * step_s;
    const bool near = std::any_of(found.begin(), found.end(), [&](const OffsetCandidate& c) {
      return std::abs(c.offset_s - offset_s) < apart_s;
    });
    if (!near) found.push_back({offset_s, score.correlation});
  }
  return found;
}

}  // namespace mixrig::trajectory

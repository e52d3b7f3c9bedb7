// SPDX-License-Identifier: Apache-2.0
#include "host/judge/measure/delay.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

namespace mixrig::measure {
namespace {

constexpr double kStep_s = 0.001;
constexpr std::size_t kFewestSamples = 8, kFewestSwitches = 4;
constexpr double kLeastCorrelation = 0.5;
constexpr double kEquallyGood = 1e-6;  // of a correlation

using Signal = std::function<double(double)>;

/// Sums over one delay.
struct Fit {
  double correlation = -1;
  double scale = 0;       ///< of the seen values to the true ones
  double residual_2 = 0;  ///< sum of squares, in seen values
};

Fit fit_at(const Signal& truth, std::span<const Sample> seen, double delay_s) {
  const double n = static_cast<double>(seen.size());
  double sx = 0, sy = 0, sxx = 0, syy = 0, sxy = 0;
  for (const Sample& s : seen) {
    const double x = truth(s.time_s - delay_s), y = s.value;
    sx += x, sy += y, sxx += x * x, syy += y * y, sxy += x * y;
  }
  const double vx = sxx - sx * sx / n, vy = syy - sy * sy / n, c = sxy - sx * sy / n;
  if (!(vx > 1e-12 * std::max(1.0, sxx)) || !(vy > 1e-12 * std::max(1.0, syy))) return {};
  return {c / std::sqrt(vx * vy), c / vx, std::max(0.0, vy - c * c / vx)};
}

/// Value between four samples around `time_s` by a cubic (Catmull and Rom), for uneven times.
double interpolated(std::span<const Sample> truth, double time_s) {
  const auto next = std::upper_bound(truth.begin(), truth.end(), time_s,
                                     [](double t, const Sample& s) { return t < s.time_s; });
  const auto at = [&](std::ptrdiff_t i) -> const Sample& {
    return truth[static_cast<std::size_t>(
        std::clamp<std::ptrdiff_t>(i, 0, static_cast<std::ptrdiff_t>(truth.size()) - 1))];
  };
  const std::ptrdiff_t i = next - truth.begin() - 1;
  const Sample &a = at(i - 1), &b = at(i), &c = at(i + 1), &d = at(i + 2);
  const double h = c.time_s - b.time_s;
  if (!(h > 0)) return b.value;
  const double t = std::clamp((time_s - b.time_s) / h, 0.0, 1.0);
  const auto slope = [&](const Sample& from, const Sample& to) {
    const double span_s = to.time_s - from.time_s;
    return span_s > 0 ? h * (to.value - from.value) / span_s : 0;
  };
  const double m0 = slope(a, c), m1 = slope(b, d), t2 = t * t, t3 = t2 * t;
  return (2 * t3 - 3 * t2 + 1) * b.value + (t3 - 2 * t2 + t) * m0 + (3 * t2 - 2 * t3) * c.value +
         (t3 - t2) * m1;
}

/// Seconds of begin..end for which a lamp that is switched at these times was on.
double lit_s(std::span<const double> switches_s, double begin_s, double end_s) {
  double sum_s = 0;
  for (std::size_t i = 0; i < switches_s.size(); i += 2) {
    const double off_s = i + 1 < switches_s.size() ? switches_s[i + 1] : end_s;
    sum_s += std::max(0.0, std::min(end_s, off_s) - std::max(begin_s, switches_s[i]));
  }
  return sum_s;
}

std::vector<Sample> within(std::span<const Sample> seen, double first_s, double last_s) {
  std::vector<Sample> used;
  for (const Sample& s : seen)
    if (s.time_s >= first_s && s.time_s <= last_s) used.push_back(s);
  return used;
}

/// Delay with the largest correlation on a grid.
double best_on_grid(const Signal& truth, std::span<const Sample> seen, double most_s) {
  double best_s = 0, best = -1;
  for (double delay_s = 0; delay_s <= most_s; delay_s += kStep_s)
    if (const double r = fit_at(truth, seen, delay_s).correlation; r > best)
      best = r, best_s = delay_s;
  return best_s;
}

/// One sigma of a delay by its Cramer-Rao bound: noise of the values over the slope of the motion.
double sigma_s(const Signal& truth, std::span<const Sample> seen, double delay_s, const Fit& fit) {
  const double n = static_cast<double>(seen.size());
  double sum = 0, sum_2 = 0;
  for (const Sample& s : seen) {
    const double at_s = s.time_s - delay_s;
    const double slope = (truth(at_s + kStep_s) - truth(at_s - kStep_s)) / (2 * kStep_s);
    sum += slope, sum_2 += slope * slope;
  }
  // An even slope only shifts the values, which says nothing of the delay.
  const double told = fit.scale * fit.scale * (sum_2 - sum * sum / n);
  const double noise_2 = std::max(fit.residual_2 / (n - 3), 1e-18);
  return told > 0 ? std::sqrt(noise_2 / told) : std::numeric_limits<double>::infinity();
}

}  // namespace

std::optional<Delay> delay_of_motion(std::span<const Sample> truth, std::span<const Sample> seen,
                                     double most_s) {
  if (truth.size() < 4) return std::nullopt;
  const std::vector<Sample> used = within(seen, truth.front().time_s + most_s, truth.back().time_s);
  if (used.size() < kFewestSamples) return std::nullopt;
  const Signal signal = [&](double time_s) { return interpolated(truth, time_s); };
  double delay_s = best_on_grid(signal, used, most_s);
  // The peak is a parabola near its top.
  const double step_s = 2 * kStep_s;
  const double before = fit_at(signal, used, delay_s - step_s).correlation;
  const double here = fit_at(signal, used, delay_s).correlation;
  const double after = fit_at(signal, used, delay_s + step_s).correlation;
  const double bend = before - 2 * here + after;
  if (bend < 0) delay_s += std::clamp(0.5 * step_s * (before - after) / bend, -step_s, step_s);
  delay_s = std::clamp(delay_s, 0.0, most_s);
  const Fit fit = fit_at(signal, used, delay_s);
  const double sigma = sigma_s(signal, used, delay_s, fit);
  if (!(fit.correlation >= kLeastCorrelation) || !(sigma <= most_s / 4)) return std::nullopt;
  return Delay{delay_s, sigma, fit.correlation};
}

std::optional<Delay> delay_of_marker(std::span<const double> switches_s,
                                     std::span<const Sample> seen, double exposure_s,
                                     double most_s) {
  if (switches_s.size() < kFewestSwitches || !(exposure_s > 0)) return std::nullopt;
  const std::vector<Sample> used = within(seen, switches_s.front() + most_s, switches_s.back());
  if (used.size() < kFewestSamples) return std::nullopt;
  const Signal signal = [&](double time_s) {
    return lit_s(switches_s, time_s - exposure_s / 2, time_s + exposure_s / 2) / exposure_s;
  };
  const double best_s = best_on_grid(signal, used, most_s);
  const double best = fit_at(signal, used, best_s).correlation;
  if (!(best >= kLeastCorrelation)) return std::nullopt;
  const auto as_good = [&](double delay_s) {
    return fit_at(signal, used, delay_s).correlation >= best - kEquallyGood;
  };
  double low_s = best_s, high_s = best_s;
  constexpr double kFine_s = kStep_s / 10;
  while (low_s - kFine_s >= 0 && as_good(low_s - kFine_s)) low_s -= kFine_s;
  while (high_s + kFine_s <= most_s && as_good(high_s + kFine_s)) high_s += kFine_s;
  return Delay{(low_s + high_s) / 2, (high_s - low_s) / 2 + kStep_s / 2, best};
}

}  // namespace mixrig::measure

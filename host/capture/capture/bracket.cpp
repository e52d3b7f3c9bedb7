// SPDX-License-Identifier: Apache-2.0
#include "host/capture/capture/bracket.h"

#include <algorithm>
#include <cmath>

#include "hal/base/srgb.h"

namespace mixrig::capture {
namespace {

/// Limits of the brighter of two plates' bytes; a kBracketStep below the lower limit is still byte
/// 36. The darker plate has no lower limit, which would select pixels that noise made brighter.
constexpr int kLeastCompared = 75, kMostCompared = 245;
constexpr double kThirdOfAStep = 1.6;

template <typename Counts>
double share_of(ImageView<const Rgb8> plate, Counts counts) {
  std::size_t count = 0;
  for (int y = 0; y < plate.size.height; ++y)
    count += static_cast<std::size_t>(
        std::count_if(plate.row(y), plate.row(y) + plate.size.width, counts));
  return plate.empty() ? 0 : static_cast<double>(count) / static_cast<double>(plate.size.area());
}

std::optional<double> exposure_at(double wanted_s, double from_s, const ExposureLimits& limits) {
  double s = std::clamp(wanted_s, limits.least_s, std::max(limits.least_s, limits.most_s));
  if (limits.step_s > 0) {
    s = limits.least_s + limits.step_s * std::round((s - limits.least_s) / limits.step_s);
    if (s > limits.most_s) s -= limits.step_s;
  }
  const double factor = s > from_s ? s / from_s : from_s / s;
  const bool towards = (s < from_s) == (wanted_s < from_s);
  if (!(s > 0) || !towards || factor < kThirdOfAStep) return {};
  return s;
}

int largest(const Rgb8& c) { return std::max({c.r, c.g, c.b}); }

}  // namespace

std::optional<double> shorter_exposure(ImageView<const Rgb8> plate, double exposure_s,
                                       const ExposureLimits& limits) {
  const double share = share_of(plate, [](const Rgb8& c) { return largest(c) >= kSaturatedByte; });
  if (share < kSaturatedShare) return {};
  return exposure_at(exposure_s / kBracketStep, exposure_s, limits);
}

std::optional<double> longer_exposure(ImageView<const Rgb8> plate, double exposure_s,
                                      const ExposureLimits& limits) {
  const double share = share_of(plate, [](const Rgb8& c) { return largest(c) <= kDarkByte; });
  if (share < kDarkShare) return {};
  return exposure_at(exposure_s * kBracketStep, exposure_s, limits);
}

void add_log_ratios(ImageView<const Rgb8> a, ImageView<const Rgb8> b, int stride,
                    std::vector<float>& to) {
  const auto& linear = linear_of_srgb_bytes();
  const auto add = [&](std::uint8_t from, std::uint8_t into) {
    const int bright = std::max(from, into);
    if (bright < kLeastCompared || bright > kMostCompared) return;
    const auto light = [&](std::uint8_t byte) { return std::max(linear[byte], 0.5F * linear[1]); };
    to.push_back(std::log(light(into) / light(from)));
  };
  std::size_t at = 0;
  for (int y = 0; y < a.size.height; ++y)
    for (int x = 0; x < a.size.width; ++x) {
      if (at++ % static_cast<std::size_t>(stride) != 0) continue;
      const Rgb8 &p = a.at(x, y), &q = b.at(x, y);
      if (std::max(largest(p), largest(q)) >= kSaturatedByte) continue;
      add(p.r, q.r), add(p.g, q.g), add(p.b, q.b);
    }
}

}  // namespace mixrig::capture

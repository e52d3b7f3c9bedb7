// SPDX-License-Identifier: Apache-2.0
#include "host/judge/measure/registration.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace mixrig::measure {
namespace {

constexpr int kReachPart = 40;     // the reach is the width over this, at least kLeastReach_px
constexpr int kLeastReach_px = 8;  // pixels
constexpr int kHole_px = 8;        // unknown pixels between near and far that a step may have
constexpr int kLeastEdge = 24;     // of 255
constexpr float kStep_m = 0.15F, kStepPart = 0.08F;

bool is_step(float near_m, float far_m) {
  return far_m - near_m > std::max(kStep_m, kStepPart * near_m);
}

/// Whether the pixels before the border, seen from it, are of the same surface.
template <typename Depth>
bool is_surface(const Depth& depth_m, int at, int side) {
  constexpr int kBehind_px = 3;
  for (int i = 1; i <= kBehind_px; ++i) {
    const float z_m = depth_m(at - side * i);
    if (!(z_m > 0) || is_step(z_m, depth_m(at)) || is_step(depth_m(at), z_m)) return false;
  }
  return true;
}

/// The next known depth within kHole_px from `from` towards `side`; 0 where there is none.
template <typename Depth>
float next_known(const Depth& depth_m, int length, int from, int side) {
  for (int i = 1; i <= kHole_px; ++i) {
    const int at = from + side * i;
    if (at < 0 || at >= length) return 0;
    if (depth_m(at) > 0) return depth_m(at);
  }
  return 0;
}

/// Takes off what most distances have in common.
void take_off_chance(std::vector<std::int64_t>& counts) {
  if (counts.empty()) return;
  std::vector<std::int64_t> sorted = counts;
  std::sort(sorted.begin(), sorted.end());
  const std::int64_t common = sorted[sorted.size() / 2];
  for (std::int64_t& count : counts) count = std::max<std::int64_t>(0, count - common);
}

double median_of(const std::vector<std::int64_t>& counts, int reach_px) {
  const std::int64_t all = std::accumulate(counts.begin(), counts.end(), std::int64_t{0});
  std::int64_t below = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    below += counts[i];
    if (all > 0 && 2 * below >= all) return static_cast<double>(i) - reach_px;
  }
  return 0;
}

}  // namespace

template <typename Depth, typename Gray>
void RegistrationMeasure::scan(int length, const Depth& depth_m, const Gray& gray, Facing ahead,
                               Facing back) {
  for (int at = reach_px_; at + reach_px_ + 1 < length; ++at) {
    if (!(depth_m(at) > 0)) continue;
    for (const int side : {1, -1}) {
      const float far_m = next_known(depth_m, length, at, side);
      if (!is_step(depth_m(at), far_m) || !is_surface(depth_m, at, side)) continue;
      const int first = side > 0 ? at : at - 1;  // the border lies behind this pixel
      int best = 0, strongest = kLeastEdge;
      for (int offset = -reach_px_; offset <= reach_px_; ++offset) {
        const int i = first + offset;
        if (i < 0 || i + 1 >= length) continue;
        const int edge = std::abs(gray(i + 1) - gray(i));
        if (edge > strongest || (edge == strongest && std::abs(offset) < std::abs(best)))
          strongest = edge, best = offset;
      }
      if (strongest > kLeastEdge)
        ++offsets_[side > 0 ? ahead : back][static_cast<std::size_t>(best + reach_px_)];
    }
  }
}

void RegistrationMeasure::add(ImageView<const float> depth_m, ImageView<const Rgb8> plate) {
  const auto [width, height] = plate.size;
  if (reach_px_ == 0) {
    reach_px_ = std::max(kLeastReach_px, width / kReachPart), width_px_ = width;
    for (auto& counts : offsets_) counts.assign(static_cast<std::size_t>(2 * reach_px_ + 1), 0);
  }
  const auto gray = [&](int x, int y) {
    const Rgb8& c = plate.row(y)[x];
    return (c.r + 2 * c.g + c.b) / 4;
  };
  for (int y = 0; y < height; ++y)
    scan(
        width, [&](int x) { return depth_m.row(y)[x]; }, [&](int x) { return gray(x, y); }, kRight,
        kLeft);
  for (int x = 0; x < width; ++x)
    scan(
        height, [&](int y) { return depth_m.row(y)[x]; }, [&](int y) { return gray(x, y); }, kDown,
        kUp);
}

Registration RegistrationMeasure::result() const {
  Registration result;
  result.width_px = width_px_;
  std::vector<std::int64_t> sizes(static_cast<std::size_t>(reach_px_ + 1), 0);
  std::array<double, kFacings> median{};
  std::int64_t all = 0, matched = 0;
  for (std::size_t facing = 0; facing < kFacings; ++facing) {
    std::vector<std::int64_t> counts = offsets_[facing];
    all += std::accumulate(counts.begin(), counts.end(), std::int64_t{0});
    take_off_chance(counts);
    for (std::size_t i = 0; i < counts.size(); ++i) {
      sizes[static_cast<std::size_t>(std::abs(static_cast<int>(i) - reach_px_))] += counts[i];
      matched += counts[i];
    }
    median[facing] = median_of(counts, reach_px_);
  }
  result.steps = static_cast<int>(all);
  result.matched_share = all > 0 ? static_cast<double>(matched) / static_cast<double>(all) : 0;
  result.median_px = median_of(sizes, 0);
  result.right_px = 0.5 * (median[kRight] + median[kLeft]);
  result.down_px = 0.5 * (median[kDown] + median[kUp]);
  result.outside_px = 0.25 * (median[kRight] - median[kLeft] + median[kDown] - median[kUp]);
  return result;
}

}  // namespace mixrig::measure

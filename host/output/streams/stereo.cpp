// SPDX-License-Identifier: Apache-2.0
#include "host/output/streams/stereo.h"

#include <algorithm>
#include <cmath>

namespace mixrig::output {
namespace {

constexpr float kTear_px = 2.5F;  ///< of the moved distance between neighbours

Rgb8 between(const Rgb8& a, const Rgb8& b, float part) {
  const auto lerp = [part](std::uint8_t from, std::uint8_t to) {
    return static_cast<std::uint8_t>(std::lround(
        static_cast<float>(from) + part * (static_cast<float>(to) - static_cast<float>(from))));
  };
  return {lerp(a.r, b.r), lerp(a.g, b.g), lerp(a.b, b.b)};
}

/// 1/z of a row; unknown ones have the farther of the known neighbours' to either side, `none`
/// where there is none.
void known_row(const float* depth_m, int width, float none, std::vector<float>& w) {
  w.resize(static_cast<std::size_t>(width));
  float left = 0;
  for (int x = 0; x < width; ++x) {
    if (depth_m[x] > 0) left = 1 / depth_m[x];
    w[static_cast<std::size_t>(x)] = left;
  }
  float right = 0;
  for (int x = width - 1; x >= 0; --x) {
    float& here = w[static_cast<std::size_t>(x)];
    if (depth_m[x] > 0) {
      right = here;
      continue;
    }
    here = here > 0 && right > 0 ? std::min(here, right) : std::max(here, right);
    if (!(here > 0)) here = none;
  }
}

/// Fills pixels that were not drawn with the farther of their neighbours in the row.
std::uint64_t fill_rest(std::vector<float>& w, std::vector<Rgb8>& color) {
  std::uint64_t filled = 0;
  const std::size_t n = w.size();
  for (std::size_t begin = 0; begin < n; ++begin) {
    if (w[begin] > 0) continue;
    std::size_t end = begin;
    while (end < n && !(w[end] > 0)) ++end;
    const bool has_left = begin > 0, has_right = end < n;
    const bool left = has_left && (!has_right || w[begin - 1] <= w[end]);
    const Rgb8 with = left ? color[begin - 1] : has_right ? color[end] : Rgb8{};
    std::fill(color.begin() + static_cast<std::ptrdiff_t>(begin),
              color.begin() + static_cast<std::ptrdiff_t>(end), with);
    filled += end - begin;
    begin = end;
  }
  return filled;
}

}  // namespace

float StereoPair::disparity_px(float w) const {
  const double d =
      options_.fx_px * options_.eye_m * (static_cast<double>(w) - 1 / options_.screen_m);
  return static_cast<float>(std::clamp(d, -options_.most_px, options_.most_px));
}

void StereoPair::move_row(const DepthPicture& from, int y, float side, bool all, Row& row) {
  const int width = from.color.size.width;
  row.w.assign(static_cast<std::size_t>(width), 0);
  row.color.resize(static_cast<std::size_t>(width));
  const Rgb8* const color = from.color.row(y);
  known_row(from.depth_m.row(y), width, static_cast<float>(1 / options_.screen_m), known_w_);
  if (!all)
    for (int x = 0; x < width; ++x)
      if (!(from.depth_m.row(y)[x] > 0)) known_w_[static_cast<std::size_t>(x)] = 0;
  const auto put = [&](int x, float w, const Rgb8& c) {
    const auto at = static_cast<std::size_t>(x);
    if (x < 0 || x >= width || !(w > row.w[at])) return;
    row.w[at] = w, row.color[at] = c;
  };
  const auto moved = [&](int x) {
    return static_cast<float>(x) +
           0.5F * side * disparity_px(known_w_[static_cast<std::size_t>(x)]);
  };
  float a = moved(0);
  put(static_cast<int>(std::lround(a)), known_w_[0], color[0]);
  for (int x = 0; x + 1 < width; ++x) {
    const float b = moved(x + 1), wa = known_w_[static_cast<std::size_t>(x)],
                wb = known_w_[static_cast<std::size_t>(x) + 1];
    if (wa > 0 && wb > 0 && b > a && b - a < kTear_px)
      for (int t = static_cast<int>(std::ceil(a)); static_cast<float>(t) <= b; ++t) {
        const float part = (static_cast<float>(t) - a) / (b - a);
        put(t, wa + part * (wb - wa), between(color[x], color[x + 1], part));
      }
    else  // a step: the pixel before and after it keep their places
      put(static_cast<int>(std::lround(a)), wa, color[x]),
          put(static_cast<int>(std::lround(b)), wb, color[x + 1]);
    a = b;
  }
}

StereoCounts StereoPair::draw(const DepthPicture& picture, const DepthPicture& behind,
                              Image<Rgb8>& out) {
  const Size size = picture.color.size;
  if (out.size() != Size{2 * size.width, size.height}) out.reset({2 * size.width, size.height});
  StereoCounts counts;
  for (int y = 0; y < size.height; ++y)
    for (int eye = 0; eye < 2; ++eye) {
      const float side = eye == 0 ? 1.0F : -1.0F;  // near things move to the right for the left eye
      move_row(picture, y, side, true, front_);
      if (!behind.color.empty()) move_row(behind, y, side, false, back_);
      for (std::size_t x = 0; x < front_.w.size(); ++x) {
        if (front_.w[x] > 0) {
          ++counts.seen;
        } else if (!behind.color.empty() && back_.w[x] > 0) {
          front_.w[x] = back_.w[x], front_.color[x] = back_.color[x];
          ++counts.behind;
        }
      }
      counts.guessed += fill_rest(front_.w, front_.color);
      std::copy(front_.color.begin(), front_.color.end(), out.row(y) + eye * size.width);
    }
  return counts;
}

}  // namespace mixrig::output

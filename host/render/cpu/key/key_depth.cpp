// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/key/key_depth.h"

#include <algorithm>
#include <cmath>

namespace mixrig::render::cpu {
namespace {

constexpr auto kOfForeground = static_cast<std::uint8_t>(PixelState::kForeground);
constexpr auto kOfDoubt = static_cast<std::uint8_t>(PixelState::kEdge);

/// The nearest foreground on one side of a pixel.
struct Beside {
  int px = kFillReachPx + 1;  // distance; over kFillReachPx: none
  float w = 0;
  bool known() const { return px <= kFillReachPx; }
};

struct DepthFill {
  const Image<std::uint8_t>& state;
  const Image<float>& view_w;
  Size size;
  glm::vec2 parallax_px_m;

  Beside beside(int x, int y, int dx, int dy) const {
    Beside out;
    for (int d = 1; d <= kFillReachPx; ++d) {
      x += dx, y += dy;
      if (x < 0 || y < 0 || x >= size.width || y >= size.height) break;
      if (state.row(y)[x] != kOfForeground) continue;
      return {d, view_w.row(y)[x]};
    }
    return out;
  }

  /// The nearer side of a pixel; its depth is the farther one of both if the place may be hidden.
  static Beside of(const Beside& a, const Beside& b, float parallax_px_m) {
    const Beside& near = a.px <= b.px ? a : b;
    if (!a.known() || !b.known()) return near;
    const float hidden_px = kFillShadow * parallax_px_m * std::abs(a.w - b.w);
    const bool may_be_hidden = static_cast<float>(a.px + b.px - 1) <= hidden_px + kFillSlackPx;
    const bool differ = std::max(a.w, b.w) > kFillRatio * std::min(a.w, b.w);
    if (may_be_hidden && differ) return {near.px, std::min(a.w, b.w)};
    return near;
  }

  float w_at(int x, int y, float otherwise) const {
    const Beside row = of(beside(x, y, -1, 0), beside(x, y, 1, 0), parallax_px_m.x);
    const Beside column = of(beside(x, y, 0, -1), beside(x, y, 0, 1), parallax_px_m.y);
    const Beside& near = row.px <= column.px ? row : column;
    return near.known() ? near.w : otherwise;
  }
};

}  // namespace

void fill_depth(const KeyInput& input, const KeyScratch& scratch, int bx, int by,
                const Image<std::uint8_t>& matte, Image<float>& view_w) {
  const DepthFill fill{scratch.state, view_w, matte.size(), parallax_px_m(input.tables.warp)};
  const float otherwise = scratch.at(bx, by).near_w;
  for (int y = block_begin(by); y < block_end(by, matte.height()); ++y)
    for (int x = block_begin(bx); x < block_end(bx, matte.width()); ++x) {
      const std::uint8_t state = scratch.state.row(y)[x];
      if (state == kOfForeground || matte.row(y)[x] == 0) continue;
      float& w = view_w.row(y)[x];
      const float beside = fill.w_at(x, y, otherwise);
      // Doubt keeps a known depth that is nearer: virtual objects must not cover it.
      w = state == kOfDoubt ? std::max(w, beside) : beside;
    }
}

}  // namespace mixrig::render::cpu

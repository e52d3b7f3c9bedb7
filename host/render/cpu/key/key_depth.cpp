// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/key/key_depth.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/render/cpu/warp/warp.h"

namespace mixrig::render::cpu {
namespace {

constexpr auto kOfForeground = static_cast<std::uint8_t>(PixelState::kForeground);
/// Least matte of foreground whose depth its surroundings take: what lost the vote is the room.
constexpr std::uint8_t kMostlyPeople = 128;
constexpr auto kOfDoubt = static_cast<std::uint8_t>(PixelState::kEdge);

/// The nearest foreground on one side of a pixel that no cut cell drew; none if the matte takes it
/// for the room.
struct Beside {
  int px = kFillReachPx + 1;  // distance; over kFillReachPx: none
  float w = 0;
  bool sure = false;  ///< surely people
  bool known() const { return px <= kFillReachPx; }
};

struct DepthFill {
  const Image<std::uint8_t>& state;
  const Image<std::uint8_t>* alone;  ///< its pixels may be changing and are not read; null: none
  const Image<std::uint8_t>& matte;
  const Image<float>& view_w;
  glm::vec2 parallax_px_m;

  Beside beside(int x, int y, int dx, int dy) const {
    for (int d = 1; d <= kFillReachPx; ++d) {
      x += dx, y += dy;
      if (x < 0 || y < 0 || x >= matte.width() || y >= matte.height()) break;
      if (state.row(y)[x] != kOfForeground || (alone && alone->row(y)[x])) continue;
      const float w = view_w.row(y)[x];
      if (from_cut_cell(w)) continue;
      const std::uint8_t share = matte.row(y)[x];
      return share >= kMostlyPeople ? Beside{d, w, static_cast<float>(share) > 255 * kFillSure}
                                    : Beside{};
    }
    return {};
  }

  /// The nearer side of a pixel; its depth is the farther one of both if the place may be hidden
  /// and people are surely there.
  static Beside of(const Beside& a, const Beside& b, float parallax_px_m) {
    const Beside& near = a.px <= b.px ? a : b;
    const Beside& rear = a.w <= b.w ? a : b;
    if (!a.known() || !b.known() || !rear.sure) return near;
    const float hidden_px = kFillShadow * parallax_px_m * std::abs(a.w - b.w);
    const bool may_be_hidden = static_cast<float>(a.px + b.px - 1) <= hidden_px + kFillSlackPx;
    const bool differ = std::max(a.w, b.w) > kFillRatio * rear.w;
    if (may_be_hidden && differ) return {near.px, rear.w, true};
    return near;
  }

  /// Left, right, above, below.
  std::array<Beside, 4> sides(int x, int y) const {
    return {beside(x, y, -1, 0), beside(x, y, 1, 0), beside(x, y, 0, -1), beside(x, y, 0, 1)};
  }

  float w_at(int x, int y, float otherwise) const {
    const std::array<Beside, 4> s = sides(x, y);
    const Beside row = of(s[0], s[1], parallax_px_m.x), column = of(s[2], s[3], parallax_px_m.y);
    const Beside& near = row.px <= column.px ? row : column;
    return near.known() ? near.w : otherwise;
  }

  /// Whether foreground of a cut cell has whole cells on some side, and none at its own depth.
  bool is_alone(int x, int y) const {
    const float own = view_w.row(y)[x];
    if (!from_cut_cell(own)) return false;
    bool known = false;
    for (const Beside& b : sides(x, y)) {
      if (!b.known()) continue;
      known = true;
      if (std::max(own, b.w) <= kFillRatio * std::min(own, b.w)) return false;
    }
    return known;
  }
};

}  // namespace

void find_alone(const KeyInput& input, int bx, int by, const Image<std::uint8_t>& matte,
                const Image<float>& view_w, KeyScratch& scratch) {
  const DepthFill fill{scratch.state, nullptr, matte, view_w, parallax_px_m(input.tables.warp)};
  for (int y = block_begin(by); y < block_end(by, matte.height()); ++y)
    for (int x = block_begin(bx); x < block_end(bx, matte.width()); ++x)
      scratch.alone.row(y)[x] =
          matte.row(y)[x] > 0 && scratch.state.row(y)[x] == kOfForeground && fill.is_alone(x, y);
}

void fill_depth(const KeyInput& input, const KeyScratch& scratch, int bx, int by,
                const Image<std::uint8_t>& matte, Image<float>& view_w) {
  const DepthFill fill{scratch.state, &scratch.alone, matte, view_w,
                       parallax_px_m(input.tables.warp)};
  const float otherwise = scratch.at(bx, by).near_w;
  for (int y = block_begin(by); y < block_end(by, matte.height()); ++y)
    for (int x = block_begin(bx); x < block_end(bx, matte.width()); ++x) {
      const std::uint8_t state = scratch.state.row(y)[x];
      const bool measured = state == kOfForeground && scratch.alone.row(y)[x] == 0;
      if (measured || matte.row(y)[x] == 0) continue;
      float& w = view_w.row(y)[x];
      const float beside = fill.w_at(x, y, otherwise);
      // Doubt keeps a known depth that is nearer: virtual objects must not cover it.
      w = state == kOfDoubt ? std::max(w, beside) : beside;
    }
}

}  // namespace mixrig::render::cpu

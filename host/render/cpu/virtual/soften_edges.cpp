// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/virtual/soften_edges.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "host/render/contract/constants.h"
#include "host/render/cpu/simd.h"

namespace mixrig::render::cpu {
namespace {

constexpr int kEdgeGrain = 16;

/// A row of `sharp`, and those above and below it, so that [x] is pixel x of the view.
struct SharpRows {
  const std::uint8_t *above, *own, *below;

  SharpRows(const Image<std::uint8_t>& sharp, int y)
      : above(sharp.row(y - 1 + kSharpMargin) + kSharpMargin),
        own(sharp.row(y + kSharpMargin) + kSharpMargin),
        below(sharp.row(y + 1 + kSharpMargin) + kSharpMargin) {}
  /// Coverage of the pixels left, right, above and below.
  std::array<int, 4> beside(int x) const { return {own[x - 1], own[x + 1], above[x], below[x]}; }
  /// Whether eight pixels from x on and all beside them are covered alike.
  bool is_even(int x) const {
    std::uint64_t any = 0, all = ~any;
    for (const std::uint8_t* p : {own + x, own + x - 1, own + x + 1, above + x, below + x}) {
      const auto eight = load<std::uint64_t>(p);
      any |= eight, all &= eight;
    }
    return any == 0 || all == ~std::uint64_t{0};
  }
};

/// Copies the rows of the rectangle and those beside it, continued past the border of the view.
void copy_coverage(Crew& crew, const VirtualLayer& layer, Image<std::uint8_t>& sharp) {
  const Size size = layer.coverage.size();
  const Rect& rect = layer.rect;
  const int x0 = std::max(rect.x0 - kSharpMargin, 0);
  const int x1 = std::min(rect.x1 + kSharpMargin, size.width);
  crew.rows(rect.y1 - rect.y0 + 2 * kSharpMargin, kEdgeGrain, [&](int begin, int end) {
    for (int y = rect.y0 - kSharpMargin + begin; y < rect.y0 - kSharpMargin + end; ++y) {
      const std::uint8_t* from = layer.coverage.row(std::clamp(y, 0, size.height - 1));
      std::uint8_t* to = sharp.row(y + kSharpMargin) + kSharpMargin;
      std::copy(from + x0, from + x1, to + x0);
      to[-1] = from[0], to[size.width] = from[size.width - 1];
    }
  });
}

/// Coverage `own` and `more`, kept on its side of kVirtualShare by a level.
float on_its_side(std::uint8_t own, float more) {
  constexpr float kLimit = 255 * kVirtualShare;
  const auto sharp = static_cast<float>(own);
  return sharp < kLimit ? std::min(sharp + more, kLimit - 1) : std::max(sharp + more, kLimit + 1);
}

/// Calls edge(x, soft) for the pixels of a row that are softened to coverage `soft`.
template <typename Edge>
void for_each_edge(const SharpRows& sharp, const Rect& rect, float tap, Edge&& edge) {
  for (int x = rect.x0; x < rect.x1; ++x) {
    while (x + 8 <= rect.x1 && sharp.is_even(x)) x += 8;
    if (x == rect.x1) return;
    const auto [left, right, above, below] = sharp.beside(x);
    const int more = left + right + above + below - 4 * sharp.own[x];
    if (more != 0) edge(x, on_its_side(sharp.own[x], tap * static_cast<float>(more)));
  }
}

Rgbx16 scaled(Rgbx16 c, float by) {
  const auto channel = [by](std::uint16_t v) {
    return static_cast<std::uint16_t>(std::min(by * static_cast<float>(v) + 0.5F, kLinearOne));
  };
  return {channel(c.r), channel(c.g), channel(c.b), 0};
}

PackedNormal with_share(PackedNormal normal, float by) {
  const float share = by * static_cast<float>(normal.w) + 0.5F;
  normal.w = static_cast<std::int8_t>(std::clamp(share, 1.0F, static_cast<float>(kWholeShare)));
  return normal;
}

/// Sets the surface of a pixel that no sample covers.
void cover(const SharpRows& sharp, int x, int y, float soft, VirtualLayer& layer) {
  const auto beside = sharp.beside(x);
  const auto most = std::max_element(beside.begin(), beside.end()) - beside.begin();
  const int from_x = x + (most == 0 ? -1 : most == 1 ? 1 : 0);
  const int from_y = y + (most == 2 ? -1 : most == 3 ? 1 : 0);
  const PackedNormal normal = layer.normal.row(from_y)[from_x];
  const float by = soft / 255 * static_cast<float>(kWholeShare) / static_cast<float>(normal.w);
  layer.coverage.row(y)[x] = static_cast<std::uint8_t>(soft + 0.5F);
  layer.w.row(y)[x] = layer.w.row(from_y)[from_x];
  layer.normal.row(y)[x] = with_share(normal, by);
  layer.color.row(y)[x] = scaled(layer.color.row(from_y)[from_x], by);
  if (!layer.gloss.empty()) layer.gloss.row(y)[x] = layer.gloss.row(from_y)[from_x];
  if (!layer.emission.empty())
    layer.emission.row(y)[x] = scaled(layer.emission.row(from_y)[from_x], by);
}

/// Scales the nearest surface of a pixel.
void scale_nearest(int x, int y, float by, VirtualLayer& layer) {
  layer.normal.row(y)[x] = with_share(layer.normal.row(y)[x], by);
  layer.color.row(y)[x] = scaled(layer.color.row(y)[x], by);
  if (!layer.emission.empty()) layer.emission.row(y)[x] = scaled(layer.emission.row(y)[x], by);
}

/// Scales the surfaces of a row's pixels that samples cover.
void scale_covered(const SharpRows& sharp, int y, float tap, VirtualLayer& layer) {
  const auto others = layer.others.row(y);
  auto other = others.begin();
  for_each_edge(sharp, layer.rect, tap, [&](int x, float soft) {
    if (sharp.own[x] == 0) return;
    const float by = soft / static_cast<float>(sharp.own[x]);
    layer.coverage.row(y)[x] = static_cast<std::uint8_t>(soft + 0.5F);
    scale_nearest(x, y, by, layer);
    while (other != others.end() && other->x < x) ++other;
    if (other == others.end() || other->x != x) return;
    other->normal = with_share(other->normal, by);
    other->albedo = scaled(other->albedo, by), other->emission = scaled(other->emission, by);
  });
}

}  // namespace

void soften_edges(Crew& crew, float tap, VirtualScratch& scratch, VirtualLayer& layer) {
  const Rect& rect = layer.rect;
  if (!(tap > 0) || rect.empty()) return;
  copy_coverage(crew, layer, scratch.sharp);
  const auto each_row = [&](auto&& soften) {
    crew.rows(rect.y1 - rect.y0, kEdgeGrain, [&](int begin, int end) {
      for (int y = rect.y0 + begin; y < rect.y0 + end; ++y) soften(SharpRows(scratch.sharp, y), y);
    });
  };
  // Pixels that are not covered read those beside them before they are scaled.
  each_row([&](const SharpRows& sharp, int y) {
    for_each_edge(sharp, rect, tap, [&](int x, float soft) {
      if (sharp.own[x] == 0) cover(sharp, x, y, soft, layer);
    });
  });
  each_row([&](const SharpRows& sharp, int y) { scale_covered(sharp, y, tap, layer); });
}

}  // namespace mixrig::render::cpu

// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/mix/look.h"

#include <algorithm>
#include <cmath>

namespace mixrig::render::cpu {
namespace {

constexpr int kBlurGrain = 16;
using AxisTaps = std::array<glm::vec4, kBlurReach + 1>;

AxisTaps axis_taps(const LookTaps& light, const LookTaps& chroma) {
  AxisTaps taps;
  for (std::size_t i = 0; i < taps.size(); ++i)
    taps[i] = {light[i], chroma[i], chroma[i], light[i]};
  return taps;
}

glm::vec4 premultiplied(const VirtualLayer& from, int x, int y) {
  const std::uint8_t coverage = from.coverage.row(y)[x];
  if (coverage == 0) return glm::vec4(0);
  const Rgbx16 c = from.color.row(y)[x];
  return to_differences({c.r, c.g, c.b, coverage});
}

/// Filters a row along x, past the layer's rectangle by the reach of the blur.
void blur_along(const VirtualLayer& from, const AxisTaps& taps, int y, const Rect& rect,
                glm::vec4* out) {
  const auto at = [&](int x) {
    return x >= from.rect.x0 && x < from.rect.x1 ? premultiplied(from, x, y) : glm::vec4(0);
  };
  std::array<glm::vec4, 2 * kBlurReach + 1> line;
  for (int i = 0; i < 2 * kBlurReach; ++i)
    line[static_cast<std::size_t>(i + 1)] = at(rect.x0 + i - kBlurReach);
  for (int x = rect.x0; x < rect.x1; ++x) {
    std::rotate(line.begin(), line.begin() + 1, line.end());
    line.back() = at(x + kBlurReach);
    out[x] = taps[0] * line[2] + taps[1] * (line[1] + line[3]) + taps[2] * (line[0] + line[4]);
  }
}

/// Inverse depth of the nearest covered pixel that the blur reaches from (x, y).
float nearest_w(const VirtualLayer& from, int x, int y) {
  float w = 0;
  for (int j = std::max(y - kBlurReach, from.rect.y0);
       j < std::min(y + kBlurReach + 1, from.rect.y1); ++j)
    for (int i = std::max(x - kBlurReach, from.rect.x0);
         i < std::min(x + kBlurReach + 1, from.rect.x1); ++i)
      w = std::max(w, from.w.row(j)[i]);
  return w;
}

std::uint16_t to_16(float v) { return static_cast<std::uint16_t>(std::min(v, kLinearOne) + 0.5F); }

/// Filters along columns. `across`: rows from `first_y` on, filtered along x.
void blur_down(const VirtualLayer& from, const AxisTaps& taps, int y,
               const Image<glm::vec4>& across, int first_y, VirtualLayer& to) {
  const auto row = [&](int j) {
    return j >= from.rect.y0 && j < from.rect.y1 ? across.row(j - first_y) : nullptr;
  };
  std::array<const glm::vec4*, 2 * kBlurReach + 1> rows;
  for (int j = 0; j < static_cast<int>(rows.size()); ++j)
    rows[static_cast<std::size_t>(j)] = row(y + j - kBlurReach);
  for (int x = to.rect.x0; x < to.rect.x1; ++x) {
    glm::vec4 all(0);
    for (std::size_t j = 0; j < rows.size(); ++j)
      if (rows[j] != nullptr)
        all +=
            taps[static_cast<std::size_t>(std::abs(static_cast<int>(j) - kBlurReach))] * rows[j][x];
    const glm::vec4 sum = from_differences(all, 255.0F);
    const auto coverage = static_cast<std::uint8_t>(std::max(sum.w, 0.0F) + 0.5F);
    to.coverage.row(y)[x] = coverage;
    if (coverage == 0) continue;
    to.color.row(y)[x] = {to_16(sum.x), to_16(sum.y), to_16(sum.z), 0};
    const bool inside =
        x >= from.rect.x0 && x < from.rect.x1 && y >= from.rect.y0 && y < from.rect.y1;
    const float own = inside ? from.w.row(y)[x] : 0;
    to.w.row(y)[x] = own > 0 ? own : nearest_w(from, x, y);
  }
}

}  // namespace

glm::vec3 GrainOf::added(const glm::vec3& color, float coverage, int x, int y) const {
  constexpr float kStep = kGrainSigmas / 127;
  const PackedNormal n =
      noise.row((y + offset.y) & (kGrainTexels - 1))[(x + offset.x) & (kGrainTexels - 1)];
  const glm::vec3 variance = grain.floor + grain.slope * (color / (coverage * kLinearOne));
  return glm::max(
      color + kStep * coverage * kLinearOne * glm::sqrt(variance) * glm::vec3(n.x, n.y, n.z), 0.0F);
}

void blur_layer(Crew& crew, const LookFilter& filter, const VirtualLayer& from,
                BlurScratch& scratch) {
  const Size size = from.coverage.size();
  VirtualLayer& to = scratch.layer;
  if (to.coverage.size() != size) {
    scratch.across.resize(static_cast<std::size_t>(crew.threads()));
    for (Image<glm::vec4>& band : scratch.across)
      band.reset({size.width, kBlurGrain + 2 * kBlurReach});
    make_layer_image(size, to.coverage), make_layer_image(size, to.w);
    make_layer_image(size, to.color);
  }
  for (int y = to.rect.y0; y < to.rect.y1; ++y)
    std::fill(to.coverage.row(y) + to.rect.x0, to.coverage.row(y) + to.rect.x1, 0);
  const Rect& r = from.rect;
  to.rect = r.empty() ? Rect{}
                      : Rect{std::max(r.x0 - kBlurReach, 0), std::max(r.y0 - kBlurReach, 0),
                             std::min(r.x1 + kBlurReach, size.width),
                             std::min(r.y1 + kBlurReach, size.height)};
  if (to.rect.empty()) return;
  const AxisTaps along = axis_taps(filter.light, filter.chroma_x);
  const AxisTaps down = axis_taps(filter.light, filter.chroma_y);
  crew.rows_by_worker(to.rect.y1 - to.rect.y0, kBlurGrain, [&](int worker, int begin, int end) {
    Image<glm::vec4>& across = scratch.across[static_cast<std::size_t>(worker)];
    const int y0 = to.rect.y0 + begin, y1 = to.rect.y0 + end, first_y = y0 - kBlurReach;
    for (int y = std::max(first_y, r.y0); y < std::min(y1 + kBlurReach, r.y1); ++y)
      blur_along(from, along, y, to.rect, across.row(y - first_y));
    for (int y = y0; y < y1; ++y) blur_down(from, down, y, across, first_y, to);
  });
}

}  // namespace mixrig::render::cpu

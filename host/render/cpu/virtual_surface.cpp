// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/virtual_surface.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "host/render/cpu/simd.h"

namespace mixrig::render::cpu {
namespace {

using I4 = std::int32_t __attribute__((vector_size(16)));
constexpr int kPixelSamples = kVirtualSamples * kVirtualSamples;
static_assert(kPixelSamples == 4, "the samples of a pixel fill an F4");
constexpr F4 kColumn = {0, 1, 0, 1}, kRow = {0, 0, 1, 1};

F4 sqrt4(F4 f) {
  for (int i = 0; i < 4; ++i) f[i] = std::sqrt(f[i]);
  return f;
}
I4 to_int4(F4 f) { return __builtin_convertvector(f, I4); }
F4 to_float4(I4 i) { return __builtin_convertvector(i, F4); }
/// Largest whole number that is not above; the value must fit.
F4 floor4(F4 f) {
  const F4 whole = to_float4(to_int4(f));
  return whole + to_float4(whole > f);  // true is -1
}

/// A vector of each of the four samples.
struct Vector4 {
  F4 x, y, z;
};
Vector4 mix(const Vector4& weights, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  return {weights.x * a.x + weights.y * b.x + weights.z * c.x,
          weights.x * a.y + weights.y * b.y + weights.z * c.y,
          weights.x * a.z + weights.y * b.z + weights.z * c.z};
}
Vector4 operator*(const glm::mat3& m, const Vector4& v) {
  return {m[0].x * v.x + m[1].x * v.y + m[2].x * v.z, m[0].y * v.x + m[1].y * v.y + m[2].y * v.z,
          m[0].z * v.x + m[1].z * v.y + m[2].z * v.z};
}
F4 dot(const Vector4& a, const Vector4& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// Linear light of each byte as a number.
const std::array<float, 256>& linear() {
  static const auto kTable = [] {
    std::array<float, 256> table;
    for (std::size_t i = 0; i < table.size(); ++i)
      table[i] = static_cast<float>(srgb_to_linear()[i]) / kLinearOne;
    return table;
  }();
  return kTable;
}

/// Texels around each sample along an axis of `size` texels, repeating, and the way between them.
struct Neighbours {
  I4 first, second;
  F4 share;
};
Neighbours neighbours(F4 value, int size) {
  const F4 at = (value - floor4(value)) * static_cast<float>(size) - 0.5F;
  const F4 low = floor4(at);
  const I4 first = to_int4(low), second = first + 1;  // from -1 to size
  return {first < 0 ? first + size : first, second >= size ? second - size : second, at - low};
}

float total(F4 f) { return f[0] + f[1] + f[2] + f[3]; }

/// Sum of the samples' texels: bilinear, repeating, in linear light. `counted`: 1 or 0 a sample.
F4 texels(ImageView<const Rgb8> texture, F4 u, F4 v, F4 counted) {
  const std::array<float, 256>& table = linear();
  const I4 sane = (u < 1e6F) & (u > -1e6F) & (v < 1e6F) & (v > -1e6F);
  const F4 inside = sane ? counted : F4{};
  const Neighbours x = neighbours(sane ? u : F4{}, texture.size.width);
  const Neighbours y = neighbours(sane ? v : F4{}, texture.size.height);
  const auto stride = static_cast<std::int32_t>(texture.stride);
  const I4 first = y.first * stride, second = y.second * stride;
  const std::array<I4, 4> at = {first + x.first, first + x.second, second + x.first,
                                second + x.second};
  const F4 low = inside * y.share, high = inside - low;
  const std::array<F4, 4> part = {high - high * x.share, high * x.share, low - low * x.share,
                                  low * x.share};
  F4 sum = F4{} + total(counted - inside);
  const auto add = [&](std::size_t corner, int i, float weight) {
    const Rgb8 p = texture.data[at[corner][i]];
    sum += F4{table[p.r], table[p.g], table[p.b], 0} * weight;
  };
  const I4 other = (at[0] != at[0][0]) | (at[3] != at[3][0]);
  const bool all_between_the_same = (other[0] | other[1] | other[2] | other[3]) == 0;
  for (std::size_t corner = 0; corner < 4; ++corner)
    if (all_between_the_same)
      add(corner, 0, total(part[corner]));
    else
      for (int i = 0; i < kPixelSamples; ++i) add(corner, i, part[corner][i]);
  return sum;
}

/// Rays (x/z, y/z, 1) of the samples of a pixel.
Vector4 rays(const PinholeParams& view, int x, int y) {
  const F4 u = 0.5F * kColumn + (static_cast<float>(x) - 0.25F);
  const F4 v = 0.5F * kRow + (static_cast<float>(y) - 0.25F);
  return {(u - view.center_px.x) / view.focal_px.x, (v - view.center_px.y) / view.focal_px.y,
          F4{} + 1.0F};
}

/// Sums over samples.
struct Surface {
  F4 albedo{};
  glm::vec3 normal{0};
};

/// Adds the `counted` samples (1 or 0) of pixel (x, y), all of one item, `w` their inverse depth.
void add(const Draw& draw, const VirtualScratch::Item& item, int x, int y, F4 w, F4 counted,
         Surface& sum) {
  const float dx = static_cast<float>(kVirtualSamples * x - item.triangle.box.x0);
  const float dy = static_cast<float>(kVirtualSamples * y - item.triangle.box.y0);
  const F4 z = 1 / w;
  const auto weight = [&](const Affine& s) {
    return (s.a * (kColumn + dx) + (s.b * (kRow + dy) + s.c)) * z;
  };
  const Vector4 weights{weight(item.triangle.share[0]), weight(item.triangle.share[1]),
                        weight(item.triangle.share[2])};
  const MeshView& mesh = *draw.mesh;
  const std::uint32_t* i = &mesh.indices[item.first_index];
  const Vector4 n = draw.params.camera_from_object_normal *
                    mix(weights, mesh.normals[i[0]], mesh.normals[i[1]], mesh.normals[i[2]]);
  F4 scale = counted / sqrt4(dot(n, n));
  if (mesh.double_sided) scale = dot(n, rays(draw.params.view, x, y)) > 0 ? -scale : scale;
  const auto total = [&](F4 f) {
    const F4 part = counted > 0 ? f * scale : F4{};
    return part[0] + part[1] + part[2] + part[3];
  };
  sum.normal += glm::vec3(total(n.x), total(n.y), total(n.z));
  const glm::vec3 color = draw.params.base_color;
  const F4 base = {color.r, color.g, color.b, 0};
  if (mesh.texture.empty() || mesh.uv.empty()) {
    sum.albedo += base * (counted[0] + counted[1] + counted[2] + counted[3]);
    return;
  }
  const glm::vec2 a = mesh.uv[i[0]], b = mesh.uv[i[1]], c = mesh.uv[i[2]];
  sum.albedo += base * texels(mesh.texture, weights.x * a.x + weights.y * b.x + weights.z * c.x,
                              weights.x * a.y + weights.y * b.y + weights.z * c.y, counted);
}

}  // namespace

void resolve(const FrameParams& params, const VirtualScratch& scratch, int x, int y, int sample_row,
             VirtualLayer& layer) {
  const auto pair = [&](const auto& image, int row) {
    return image.row(row) + kVirtualSamples * x;
  };
  const float *upper = pair(scratch.sample_w, sample_row),
              *lower = pair(scratch.sample_w, sample_row + 1);
  const F4 w = {upper[0], upper[1], lower[0], lower[1]};
  I4 left = w > 0;
  const int covered = -(left[0] + left[1] + left[2] + left[3]);
  layer.coverage.row(y)[x] =
      static_cast<std::uint8_t>((255 * covered + kPixelSamples / 2) / kPixelSamples);
  layer.w.row(y)[x] = std::max(std::max(w[0], w[1]), std::max(w[2], w[3]));
  if (covered == 0) return;
  const std::uint32_t *upper_item = pair(scratch.sample_item, sample_row),
                      *lower_item = pair(scratch.sample_item, sample_row + 1);
  const std::array<std::uint32_t, kPixelSamples> items = {upper_item[0], upper_item[1],
                                                          lower_item[0], lower_item[1]};
  const I4 number = std::bit_cast<I4>(items);
  Surface sum;
  for (int i = 0; i < kPixelSamples; ++i) {
    if (!left[i]) continue;
    const VirtualScratch::Item& item = scratch.items[items[static_cast<std::size_t>(i)]];
    const I4 same = left & (number == number[i]);
    const F4 counted = same ? F4{} + 1.0F : F4{};
    add(params.draws[item.draw], item, x, y, same ? w : F4{} + 1.0F, counted, sum);
    left &= ~same;
  }
  const F4 mean = sum.albedo / static_cast<float>(kPixelSamples);
  const F4 c = (mean < 1 ? mean : F4{} + 1.0F) * kLinearOne + 0.5F;
  layer.color.row(y)[x] = {static_cast<std::uint16_t>(c[0]), static_cast<std::uint16_t>(c[1]),
                           static_cast<std::uint16_t>(c[2]), 0};
  const glm::vec3 n = glm::round(127.0F * glm::normalize(sum.normal + glm::vec3(0, 0, -1e-6F)));
  layer.normal.row(y)[x] = {static_cast<std::int8_t>(n.x), static_cast<std::int8_t>(n.y),
                            static_cast<std::int8_t>(n.z), 0};
}

}  // namespace mixrig::render::cpu

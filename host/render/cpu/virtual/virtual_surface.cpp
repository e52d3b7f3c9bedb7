// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/virtual/virtual_surface.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>

#include "host/render/cpu/simd.h"

namespace mixrig::render::cpu {
namespace {

constexpr F4 kColumn = {kSampleColumn[0], kSampleColumn[1], kSampleColumn[2], kSampleColumn[3]};
constexpr F4 kRow = {kSampleRow[0], kSampleRow[1], kSampleRow[2], kSampleRow[3]};

F4 sqrt4(F4 f) {
  for (int i = 0; i < 4; ++i) f[i] = std::sqrt(f[i]);
  return f;
}
I4 to_int4(F4 f) { return __builtin_convertvector(f, I4); }
F4 to_float4(I4 i) { return __builtin_convertvector(i, F4); }
/// Largest integer not above f; the value must fit.
F4 floor4(F4 f) {
  const F4 whole = to_float4(to_int4(f));
  return whole + to_float4(whole > f);  // true is -1
}

/// A vector for each of the four samples.
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

/// Texels around each sample along an axis of `size` repeating texels, and the fraction between
/// them.
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

/// Each byte over 255.
const std::array<float, 256>& shares() {
  static const auto kTable = [] {
    std::array<float, 256> table;
    for (std::size_t i = 0; i < table.size(); ++i) table[i] = static_cast<float>(i) / 255;
    return table;
  }();
  return kTable;
}

/// Sum of the samples' texels, decoded by `table`: bilinear, repeating. `counted`: 1 or 0 a sample.
F4 texels(ImageView<const Rgb8> texture, const std::array<float, 256>& table, F4 u, F4 v,
          F4 counted) {
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

/// Sums over samples of one surface.
struct Surface {
  F4 albedo{}, emission{};
  F4 gloss{};  ///< metallic, roughness, specular
  glm::vec3 normal{0};
  int count = 0;
};

/// Texture coordinates of the samples of one item.
struct OnMesh {
  F4 u, v;
  F4 counted;  ///< 1 or 0 a sample
};

F4 of_color(const glm::vec3& c) { return F4{c.r, c.g, c.b, 0}; }

/// Multiplies a colour by the samples' texels of a map, if there is one.
F4 mapped(F4 color, ImageView<const Rgb8> map, const std::array<float, 256>& table,
          const OnMesh& at) {
  return color *
         (map.empty() ? F4{} + total(at.counted) : texels(map, table, at.u, at.v, at.counted));
}

/// A pixel's normal by the normal map: tangents along u and against v of the triangle.
glm::vec3 bent_normal(const MeshView& mesh, const std::array<glm::vec3, 3>& corners_m,
                      const std::uint32_t* index, const glm::vec3& normal, const OnMesh& at) {
  const glm::vec3 e1 = corners_m[1] - corners_m[0], e2 = corners_m[2] - corners_m[0];
  const glm::vec2 d1 = mesh.uv[index[1]] - mesh.uv[index[0]];
  const glm::vec2 d2 = mesh.uv[index[2]] - mesh.uv[index[0]];
  const float turn = d1.x * d2.y - d1.y * d2.x < 0 ? -1.0F : 1.0F;
  const glm::vec3 along = turn * (e1 * d2.y - e2 * d1.y), up = turn * (e1 * d2.x - e2 * d1.x);
  const glm::vec3 flat = along - glm::dot(along, normal) * normal;
  const float length = glm::length(flat), count = total(at.counted);
  if (!(length > 0) || !(count > 0)) return normal;
  const glm::vec3 tangent = flat / length, across = glm::cross(normal, tangent);
  const glm::vec3 bitangent = glm::dot(across, up) < 0 ? -across : across;
  const F4 texel = texels(mesh.normal_map, shares(), at.u, at.v, at.counted) / count * 2.0F - 1.0F;
  return glm::normalize(mesh.normal_scale * (texel[0] * tangent + texel[1] * bitangent) +
                        std::max(texel[2], 1e-3F) * normal);
}

/// The samples of one item, with their interpolation weights and normals.
struct OfItem {
  const VirtualScratch::Item* item;
  I4 mask;          ///< samples of the pixel that show it
  Vector4 weights;  ///< of the triangle's corners
  Vector4 normal;   ///< unit; zero outside `mask`
};

/// `w`: inverse depth of the samples, 1 outside `mask`.
OfItem at_item(const Draw& draw, const VirtualScratch::Item& item, int x, int y, F4 w, I4 mask) {
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
  const I4 counted = mask & (dot(n, n) > 0);
  F4 scale = 1 / sqrt4(counted ? dot(n, n) : F4{} + 1.0F);
  if (mesh.double_sided) scale = dot(n, rays(draw.params.view, x, y)) > 0 ? -scale : scale;
  const auto scaled = [&](F4 f) { return counted ? f * scale : F4{}; };
  return {&item, mask, weights, {scaled(n.x), scaled(n.y), scaled(n.z)}};
}

/// Adds those samples of `among` that show the item.
void add(const Draw& draw, const VirtualScratch& scratch, const OfItem& of, I4 among,
         Surface& sum) {
  const I4 mask = of.mask & among;
  const F4 counted = mask ? F4{} + 1.0F : F4{};
  if (!(total(counted) > 0)) return;
  const MeshView& mesh = *draw.mesh;
  const std::uint32_t* i = &mesh.indices[of.item->first_index];
  const auto of_mask = [&](F4 f) { return total(mask ? f : F4{}); };
  const glm::vec3 normal(of_mask(of.normal.x), of_mask(of.normal.y), of_mask(of.normal.z));
  sum.count += static_cast<int>(total(counted));
  const F4 base = of_color(draw.params.base_color), glow = of_color(mesh.emission);
  const F4 gloss = {mesh.gloss.metallic, mesh.gloss.roughness, mesh.gloss.specular, 0};
  if (mesh.uv.empty()) {
    const float count = total(counted);
    sum.albedo += base * count, sum.emission += glow * count, sum.gloss += gloss * count;
    sum.normal += normal;
    return;
  }
  const glm::vec2 a = mesh.uv[i[0]], b = mesh.uv[i[1]], c = mesh.uv[i[2]];
  const OnMesh at{of.weights.x * a.x + of.weights.y * b.x + of.weights.z * c.x,
                  of.weights.x * a.y + of.weights.y * b.y + of.weights.z * c.y, counted};
  sum.albedo += mapped(base, mesh.texture, linear_of_byte(), at);
  sum.emission += mapped(glow, mesh.emission_map, linear_of_byte(), at);
  if (mesh.gloss_map.empty()) {
    sum.gloss += gloss * total(counted);
  } else {
    const F4 map = texels(mesh.gloss_map, shares(), at.u, at.v, at.counted);
    sum.gloss += gloss * F4{map[2], map[1], total(counted), 0};
  }
  if (mesh.normal_map.empty() || normal == glm::vec3(0)) {
    sum.normal += normal;
    return;
  }
  const auto& p = scratch.positions_m[of.item->draw];
  sum.normal += total(counted) *
                bent_normal(mesh, {p[i[0]], p[i[1]], p[i[2]]}, i, glm::normalize(normal), at);
}

/// Samples of `items` that belong to the nearest surface; `w` is 0 where nothing is covered.
I4 nearest_surface(std::span<const OfItem> items, F4 w) {
  Vector4 normal{};
  for (const OfItem& of : items) {
    normal.x += of.normal.x, normal.y += of.normal.y, normal.z += of.normal.z;
  }
  int nearest = 0;
  for (int i = 1; i < kPixelSamples; ++i)
    if (w[i] > w[nearest]) nearest = i;
  const F4 cosine =
      normal.x * normal.x[nearest] + normal.y * normal.y[nearest] + normal.z * normal.z[nearest];
  I4 like = (cosine >= kOneSurfaceCosine) & (w >= kOneSurfacePart * w[nearest]);
  like[nearest] = -1;
  return (w > 0) & like;
}

std::uint16_t linear16(float share) {
  return static_cast<std::uint16_t>(std::min(share, 1.0F) * kLinearOne + 0.5F);
}
std::uint8_t byte_of(float share) {
  return static_cast<std::uint8_t>(255 * std::clamp(share, 0.0F, 1.0F) + 0.5F);
}

Rgbx16 fixed(F4 sum) {
  const F4 mean = sum / static_cast<float>(kPixelSamples);
  return {linear16(mean[0]), linear16(mean[1]), linear16(mean[2]), 0};
}
PackedNormal packed_normal(const Surface& sum) {
  const glm::vec3 n = glm::round(127.0F * glm::normalize(sum.normal + glm::vec3(0, 0, -1e-6F)));
  return {static_cast<std::int8_t>(n.x), static_cast<std::int8_t>(n.y),
          static_cast<std::int8_t>(n.z), static_cast<std::int8_t>(sum.count * kSampleShare)};
}
GlossBytes gloss_bytes(const Surface& sum) {
  const F4 gloss = sum.gloss / static_cast<float>(sum.count);
  return {byte_of(gloss[0]), byte_of(gloss[1]), byte_of(gloss[2])};
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
  std::array<OfItem, kPixelSamples> kept;
  std::size_t count = 0;
  for (int i = 0; i < kPixelSamples; ++i) {
    if (!left[i]) continue;
    const VirtualScratch::Item& item = scratch.items[items[static_cast<std::size_t>(i)]];
    const I4 same = left & (number == number[i]);
    kept[count++] = at_item(params.draws[item.draw], item, x, y, same ? w : F4{} + 1.0F, same);
    left &= ~same;
  }
  const auto of_items = std::span<const OfItem>(kept).first(count);
  const auto sum_of = [&](I4 among) {
    Surface sum;
    for (const OfItem& of : of_items) add(params.draws[of.item->draw], scratch, of, among, sum);
    return sum;
  };
  const I4 mask = nearest_surface(of_items, w), rest = (w > 0) & ~mask;
  const Surface first = sum_of(mask);
  layer.color.row(y)[x] = fixed(first.albedo);
  layer.normal.row(y)[x] = packed_normal(first);
  if (!layer.gloss.empty()) layer.gloss.row(y)[x] = gloss_bytes(first);
  if (!layer.emission.empty()) layer.emission.row(y)[x] = fixed(first.emission);
  const F4 rest_w = rest ? w : F4{};
  const float behind = std::max(std::max(rest_w[0], rest_w[1]), std::max(rest_w[2], rest_w[3]));
  if (!(behind > 0)) return;
  const Surface other = sum_of(rest);
  layer.others.add(y, {x,
                       behind,
                       packed_normal(other),
                       gloss_bytes(other),
                       fixed(other.albedo),
                       fixed(other.emission),
                       {}});
}

}  // namespace mixrig::render::cpu

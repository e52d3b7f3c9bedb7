// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/virtual.h"

#include <algorithm>
#include <cmath>

namespace mixrig::render::cpu {
namespace {

constexpr int kBandRows = 16;

/// Bilinear, repeating, in linear light.
glm::vec3 texel(ImageView<const Rgb8> texture, glm::vec2 uv) {
  const auto& linear = srgb_to_linear();
  const auto wrap = [](float value, int size) {
    const float at = (value - std::floor(value)) * static_cast<float>(size) - 0.5F;
    const int first = static_cast<int>(std::floor(at));
    return std::tuple((first + size) % size, (first + 1) % size, at - static_cast<float>(first));
  };
  if (!(std::abs(uv.x) < 1e6F && std::abs(uv.y) < 1e6F)) return glm::vec3(1);
  const auto [x0, x1, fx] = wrap(uv.x, texture.size.width);
  const auto [y0, y1, fy] = wrap(uv.y, texture.size.height);
  const auto at = [&](int x, int y) {
    const Rgb8 p = texture.row(y)[x];
    return glm::vec3(linear[p.r], linear[p.g], linear[p.b]);
  };
  const glm::vec3 top = glm::mix(at(x0, y0), at(x1, y0), fx);
  return glm::mix(top, glm::mix(at(x0, y1), at(x1, y1), fx), fy) / kLinearOne;
}

struct Surface {
  glm::vec3 albedo, normal;
};

/// Albedo and camera-axes normal of an item at perspective-correct weights.
Surface surface_at(const Draw& draw, const VirtualScratch::Item& item, glm::vec3 weights,
                   glm::vec3 ray) {
  const MeshView& mesh = *draw.mesh;
  const auto mix = [&](const auto& values) {
    const std::uint32_t* i = &mesh.indices[item.first_index];
    return values[i[0]] * weights.x + values[i[1]] * weights.y + values[i[2]] * weights.z;
  };
  glm::vec3 normal = glm::normalize(draw.params.camera_from_object_normal * mix(mesh.normals));
  if (mesh.double_sided && glm::dot(normal, ray) > 0) normal = -normal;
  const bool textured = !mesh.texture.empty() && !mesh.uv.empty();
  const glm::vec3 albedo =
      draw.params.base_color * (textured ? texel(mesh.texture, mix(mesh.uv)) : glm::vec3(1));
  return {albedo, normal};
}

SampleGrid sample_grid(const PinholeParams& view, const Rect& rect) {
  // Sample i of an axis lies at pixel (i - 0.5) / 2.
  return {glm::dvec2(view.focal_px) * double(kVirtualSamples),
          glm::dvec2(view.center_px) * double(kVirtualSamples) + 0.5,
          {rect.x0 * kVirtualSamples, rect.y0 * kVirtualSamples, rect.x1 * kVirtualSamples,
           rect.y1 * kVirtualSamples}};
}

void transform_vertices(Crew& crew, const FrameParams& params, VirtualScratch& scratch) {
  for (std::size_t k = 0; k < params.draws.size(); ++k) {
    const Draw& draw = params.draws[k];
    std::vector<glm::vec3>& to = scratch.positions_m[k];
    crew.rows(static_cast<int>(to.size()), 4096, [&](int begin, int end) {
      for (int i = begin; i < end; ++i)
        to[static_cast<std::size_t>(i)] = transform(
            draw.params.camera_from_object, draw.mesh->positions_m[static_cast<std::size_t>(i)]);
    });
  }
}

void set_up_items(Crew& crew, const FrameParams& params, VirtualScratch& scratch) {
  crew.rows(static_cast<int>(scratch.items.size()), 1024, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      VirtualScratch::Item& item = scratch.items[static_cast<std::size_t>(i)];
      const Draw& draw = params.draws[item.draw];
      const std::uint32_t* index = &draw.mesh->indices[item.first_index];
      const auto& p = scratch.positions_m[item.draw];
      const auto triangle = set_up(p[index[0]], p[index[1]], p[index[2]],
                                   sample_grid(draw.params.view, params.virtual_rect),
                                   draw.mesh->double_sided ? Facing::kBoth : Facing::kFront);
      item.triangle = triangle.value_or(Triangle{});
    }
  });
}

/// Mean of the covered samples of a pixel.
void resolve_pixel(const FrameParams& params, const VirtualScratch& scratch, int x, int y,
                   const float* w_rows, const std::uint32_t* item_rows, std::ptrdiff_t stride,
                   VirtualLayer& layer) {
  int covered = 0;
  float nearest_w = 0;
  glm::vec3 albedo(0), normal(0);
  for (int j = 0; j < kVirtualSamples; ++j)
    for (int i = 0; i < kVirtualSamples; ++i) {
      const float w = w_rows[j * stride + i];
      if (!(w > 0)) continue;
      const auto& item = scratch.items[item_rows[j * stride + i]];
      const Draw& draw = params.draws[item.draw];
      const float dx = static_cast<float>(kVirtualSamples * x + i - item.triangle.box.x0);
      const float dy = static_cast<float>(kVirtualSamples * y + j - item.triangle.box.y0);
      glm::vec3 weights;
      for (int k = 0; k < 3; ++k) {
        const Affine& s = item.triangle.share[static_cast<std::size_t>(k)];
        weights[k] = (s.a * dx + (s.b * dy + s.c)) / w;
      }
      const glm::vec2 px(static_cast<float>(x) + 0.5F * static_cast<float>(i) - 0.25F,
                         static_cast<float>(y) + 0.5F * static_cast<float>(j) - 0.25F);
      const glm::vec3 ray((px - draw.params.view.center_px) / draw.params.view.focal_px, 1);
      const Surface surface = surface_at(draw, item, weights, ray);
      albedo += surface.albedo;
      normal += surface.normal;
      nearest_w = std::max(nearest_w, w);
      ++covered;
    }
  constexpr int kPixelSamples = kVirtualSamples * kVirtualSamples;
  layer.coverage.row(y)[x] =
      static_cast<std::uint8_t>((255 * covered + kPixelSamples / 2) / kPixelSamples);
  layer.w.row(y)[x] = nearest_w;
  if (covered == 0) return;
  const glm::vec3 c = glm::min(albedo / float(kPixelSamples), glm::vec3(1)) * kLinearOne + 0.5F;
  layer.color.row(y)[x] = {static_cast<std::uint16_t>(c.r), static_cast<std::uint16_t>(c.g),
                           static_cast<std::uint16_t>(c.b), 0};
  const glm::vec3 n = glm::round(127.0F * glm::normalize(normal + glm::vec3(0, 0, -1e-6F)));
  layer.normal.row(y)[x] = {static_cast<std::int8_t>(n.x), static_cast<std::int8_t>(n.y),
                            static_cast<std::int8_t>(n.z), 0};
}

/// Samples of view rows [y0, y1), then their means.
void draw_band(const FrameParams& params, VirtualScratch& scratch, int worker, int y0, int y1,
               VirtualLayer& layer) {
  const Rect& rect = layer.rect;
  const int first = worker * kBandRows * kVirtualSamples;
  const auto row_of = [&](int sample_y) { return first + sample_y - y0 * kVirtualSamples; };
  for (int y = y0 * kVirtualSamples; y < y1 * kVirtualSamples; ++y)
    std::fill_n(scratch.sample_w.row(row_of(y)), scratch.sample_w.width(), 0.0F);
  for (std::size_t i = 0; i < scratch.items.size(); ++i)
    for_each_sample(scratch.items[i].triangle, y0 * kVirtualSamples, y1 * kVirtualSamples,
                    [&](int x, int y, float w, const glm::vec3&) {
                      float& nearest = scratch.sample_w.row(row_of(y))[x];
                      if (!(w > nearest)) return;
                      nearest = w;
                      scratch.sample_item.row(row_of(y))[x] = static_cast<std::uint32_t>(i);
                    });
  for (int y = y0; y < y1; ++y)
    for (int x = rect.x0; x < rect.x1; ++x)
      resolve_pixel(params, scratch, x, y,
                    scratch.sample_w.row(row_of(kVirtualSamples * y)) + kVirtualSamples * x,
                    scratch.sample_item.row(row_of(kVirtualSamples * y)) + kVirtualSamples * x,
                    scratch.sample_w.stride(), layer);
}

}  // namespace

VirtualScratch::VirtualScratch(const FrameParams& params, Size view_size, int threads) {
  for (std::size_t k = 0; k < params.draws.size(); ++k) {
    const MeshView& mesh = *params.draws[k].mesh;
    positions_m.emplace_back(mesh.positions_m.size());
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
      items.push_back({{}, static_cast<std::uint32_t>(k), static_cast<std::uint32_t>(i)});
  }
  if (items.empty()) return;
  const Size samples{kVirtualSamples * view_size.width, kVirtualSamples * kBandRows * threads};
  sample_w.reset(samples);
  sample_item.reset(samples);
}

void draw_virtual(Crew& crew, const FrameParams& params, VirtualScratch& scratch,
                  VirtualLayer& layer) {
  for (int y = layer.rect.y0; y < layer.rect.y1; ++y) {
    std::fill(layer.coverage.row(y) + layer.rect.x0, layer.coverage.row(y) + layer.rect.x1, 0);
    std::fill(layer.w.row(y) + layer.rect.x0, layer.w.row(y) + layer.rect.x1, 0.0F);
  }
  layer.rect = params.virtual_rect;
  if (layer.rect.empty()) return;
  transform_vertices(crew, params, scratch);
  set_up_items(crew, params, scratch);
  const int top = layer.rect.y0;
  crew.rows_by_worker(layer.rect.y1 - top, kBandRows, [&](int worker, int begin, int end) {
    draw_band(params, scratch, worker, top + begin, top + end, layer);
  });
}

}  // namespace mixrig::render::cpu

// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/virtual/virtual.h"

#include <algorithm>
#include <cmath>

#include "host/render/cpu/virtual/virtual_lanes.h"
#include "host/render/cpu/virtual/virtual_surface.h"

namespace mixrig::render::cpu {
namespace {

constexpr int kBandRows = 16;

SampleGrid sample_grid(const PinholeParams& view, const Rect& rect) {
  // Sample i of an axis lies at pixel (i - 0.5) / 2.
  return {glm::dvec2(view.focal_px) * double(kVirtualSamples),
          glm::dvec2(view.center_px) * double(kVirtualSamples) + 0.5,
          {rect.x0 * kVirtualSamples, rect.y0 * kVirtualSamples, rect.x1 * kVirtualSamples,
           rect.y1 * kVirtualSamples},
          kSampleTurn};
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
      scratch.item_rows[static_cast<std::size_t>(i)] = {item.triangle.box.y0, item.triangle.box.y1};
      if (triangle && scratch.fits[item.draw])
        scratch.surfaces[static_cast<std::size_t>(i)] =
            surface_of(draw, item.triangle, item.first_index);
    }
  });
}

void resolve_row(const FrameParams& params, const VirtualScratch& scratch, int y, int sample_row,
                 VirtualLayer& layer) {
  const Rect& rect = layer.rect;
  const int last_x = layer.w.width() - kLanes;
  for (int x = rect.x0; x < rect.x1; x += kLanes) {
    // Samples outside the rectangle are not covered.
    const int first = std::min(x, last_x);
    if (first >= 0 && resolve_lanes(params, scratch, first, y, sample_row, x - first, layer))
      continue;
    for (int i = x; i < std::min(x + kLanes, rect.x1); ++i)
      resolve(params, scratch, i, y, sample_row, layer);
  }
}

/// Draws the samples of view rows [y0, y1) and resolves them.
void draw_band(const FrameParams& params, VirtualScratch& scratch, int worker, int y0, int y1,
               VirtualLayer& layer) {
  const int first = worker * kBandRows * kVirtualSamples;
  const auto row_of = [&](int sample_y) { return first + sample_y - y0 * kVirtualSamples; };
  const int begin = y0 * kVirtualSamples, end = y1 * kVirtualSamples;
  // Registers of pixels may begin before the rectangle, or end after it.
  const int width = scratch.sample_w.width();
  const int x0 = kVirtualSamples * std::max(std::min(layer.rect.x0, layer.w.width() - kLanes), 0);
  const int x1 = std::min(kVirtualSamples * (layer.rect.x1 + kLanes), width);
  for (int y = begin; y < end; ++y)
    std::fill(scratch.sample_w.row(row_of(y)) + x0, scratch.sample_w.row(row_of(y)) + x1, 0.0F);
  for (std::size_t i = 0; i < scratch.items.size(); ++i) {
    if (scratch.item_rows[i].begin >= end || scratch.item_rows[i].end <= begin) continue;
    for_each_run(scratch.items[i].triangle, begin, end, scratch.sample_w.width() - kLanes,
                 kSampleTurn, [&](int x, int y, FloatLanes w, IntLanes inside) {
                   float* const nearest = scratch.sample_w.row(row_of(y)) + x;
                   std::uint32_t* const item = scratch.sample_item.row(row_of(y)) + x;
                   const FloatLanes old = load<FloatLanes>(nearest);
                   const IntLanes nearer = inside & (w > old);
                   store(nearest, nearer ? w : old);
                   const IntLanes number = IntLanes{} + static_cast<std::int32_t>(i);
                   store(item, nearer ? number : load<IntLanes>(item));
                 });
  }
  for (int y = y0; y < y1; ++y) resolve_row(params, scratch, y, row_of(kVirtualSamples * y), layer);
}

}  // namespace

void VirtualLayer::reset(Size size, bool glossy, bool emits) {
  make_layer_image(size, coverage), make_layer_image(size, w);
  make_layer_image(size, normal), make_layer_image(size, color);
  if (glossy) make_layer_image(size, gloss);
  if (emits) make_layer_image(size, emission);
  others.make(size);
}

VirtualScratch::VirtualScratch(const FrameParams& params, Size view_size, int threads) {
  for (std::size_t k = 0; k < params.draws.size(); ++k) {
    const MeshView& mesh = *params.draws[k].mesh;
    fits.push_back(fits_lanes(mesh));
    positions_m.emplace_back(mesh.positions_m.size());
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
      items.push_back({{}, static_cast<std::uint32_t>(k), static_cast<std::uint32_t>(i)});
  }
  if (items.empty()) return;
  surfaces.resize(items.size());
  item_rows.resize(items.size());
  const Size samples{std::max(kVirtualSamples * view_size.width, kLanes),
                     kVirtualSamples * kBandRows * threads};
  sample_w.reset(samples);
  sample_item.reset(samples);
  make_layer_image({view_size.width + 2 * kSharpMargin, view_size.height + 2 * kSharpMargin},
                   sharp);
}

void draw_virtual(Crew& crew, const FrameParams& params, VirtualScratch& scratch,
                  VirtualLayer& layer) {
  for (int y = layer.rect.y0; y < layer.rect.y1; ++y) {
    std::fill(layer.coverage.row(y) + layer.rect.x0, layer.coverage.row(y) + layer.rect.x1, 0);
    std::fill(layer.w.row(y) + layer.rect.x0, layer.w.row(y) + layer.rect.x1, 0.0F);
  }
  layer.rect = params.virtual_rect;
  layer.others.reset(layer.rect);
  if (layer.rect.empty()) return;
  transform_vertices(crew, params, scratch);
  set_up_items(crew, params, scratch);
  const int top = layer.rect.y0;
  crew.rows_by_worker(layer.rect.y1 - top, kBandRows, [&](int worker, int begin, int end) {
    draw_band(params, scratch, worker, top + begin, top + end, layer);
  });
}

}  // namespace mixrig::render::cpu

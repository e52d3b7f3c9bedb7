// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/warp/warp.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "host/render/cpu/simd.h"
#include "host/render/cpu/warp/draw_quads.h"
#include "host/render/cpu/warp/surface_reach.h"

namespace mixrig::render::cpu {
namespace {

constexpr auto kNearM = static_cast<float>(kNearestM);

Vertex project(const WarpParams& p, glm::vec2 ray, float w) {
  const glm::vec3 q =
      glm::mat3(p.camera_from_tof) * glm::vec3(ray, 1) + glm::vec3(p.camera_from_tof[3]) * w;
  // q is the point times its own w: q_z / w is the depth in the view.
  if (!(w > 0) || !(q.z > kNearM * w)) return {0, 0, 0};
  const float inverse = 1 / q.z;
  return {p.view.focal_px.x * q.x * inverse + p.view.center_px.x,
          p.view.focal_px.y * q.y * inverse + p.view.center_px.y, w * inverse};
}

void project_row(const WarpParams& params, const glm::vec2* ray, const float* w, int width, int y,
                 WarpScratch& out) {
  float* u_px = out.u_px.row(y);
  float* v_px = out.v_px.row(y);
  float* view_w = out.w.row(y);
  for (int x = 0; x < width; ++x) {
    const Vertex vertex = project(params, ray[x], w[x]);
    u_px[x] = vertex.u;
    v_px[x] = vertex.v;
    view_w[x] = vertex.w;
  }
}

/// Inputs of a cell.
struct Mesh {
  const WarpParams& params;
  const Image<glm::vec2>& tof_ray;
  const TofGrid& grid;
  const WarpScratch& vertices;

  Vertex vertex(int x, int y) const {
    return {vertices.u_px.row(y)[x], vertices.v_px.row(y)[x], vertices.w.row(y)[x]};
  }
  const std::uint8_t* links(int x, int y) const { return grid.links.row(y + kFrame) + x + kFrame; }
};

/// Whether all links of a cell hold.
bool is_whole(const std::uint8_t* links, std::ptrdiff_t stride) {
  constexpr int kFirst = kRight | kDown | kDownRight, kSecond = kDown | kDownLeft;
  return ((links[0] & kFirst) == kFirst) & ((links[1] & kSecond) == kSecond) &
         ((links[stride] & kRight) != 0);
}

/// Adds up to kLanes whole cells from (x, y) on, each split along the diagonal with the smaller
/// change of w. `drawn` is -1 for those that exist.
void put_whole(const Mesh& mesh, int x, int y, IntLanes drawn, std::size_t first, QuadBatch& out) {
  const float* w = mesh.grid.w.row(y + kFrame) + x + kFrame;
  const float* below = w + mesh.grid.w.stride();
  const IntLanes down_right = abs(load<FloatLanes>(w) - load<FloatLanes>(below + 1)) <=
                              abs(load<FloatLanes>(w + 1) - load<FloatLanes>(below));
  const auto put = [&](const Image<float>& of, std::array<QuadBatch::Row, 4>& to) {
    const FloatLanes v00 = load<FloatLanes>(of.row(y) + x);
    const FloatLanes v10 = load<FloatLanes>(of.row(y) + x + 1);
    const FloatLanes v01 = load<FloatLanes>(of.row(y + 1) + x);
    const FloatLanes v11 = load<FloatLanes>(of.row(y + 1) + x + 1);
    store(&to[0][first], down_right ? v00 : v10);
    store(&to[1][first], down_right ? v10 : v11);
    store(&to[2][first], down_right ? v11 : v01);
    store(&to[3][first], down_right ? v01 : v00);
    return min(min(v00, v10), min(v01, v11));
  };
  put(mesh.vertices.u_px, out.u_px);
  put(mesh.vertices.v_px, out.v_px);
  const IntLanes known = put(mesh.vertices.w, out.w) > 0;
  for (QuadBatch::Row& u_px : out.u_px) {
    const FloatLanes u = load<FloatLanes>(&u_px[first]);
    store(&u_px[first], drawn & known ? u : FloatLanes{} - 1);
  }
}

/// Mean change of w from a sample to the next along `d`, over the links that hold.
float gradient(const float* w, const std::uint8_t* links, std::ptrdiff_t d_w,
               std::ptrdiff_t d_links, Link link) {
  const bool ahead = links[0] & link, behind = links[-d_links] & link;
  const float sum = (ahead ? w[d_w] - w[0] : 0) + (behind ? w[0] - w[-d_w] : 0);
  return ahead && behind ? 0.5F * sum : sum;
}

/// Collects cut cells and draws them a batch at a time.
class CutCells {
 public:
  CutCells(const Mesh& mesh, const Band& band, Image<float>& view_w)
      : mesh_(mesh), reach_(mesh.params, mesh.tof_ray, mesh.grid), band_(band), view_w_(view_w) {}

  void add(int x, int y) {
    add_quarter(x, y, 1, 1);
    add_quarter(x + 1, y, -1, 1);
    add_quarter(x, y + 1, 1, -1);
    add_quarter(x + 1, y + 1, -1, -1);
  }
  void draw() {
    draw_quads(quads_, true, band_, view_w_);
    quads_.count = 0;
  }

 private:
  void add_quarter(int x, int y, int right, int down);

  const Mesh& mesh_;
  const SurfaceReach reach_;
  const Band& band_;
  Image<float>& view_w_;
  QuadBatch quads_;
};

/// Adds the quarter of the cell next to vertex (x, y), towards (x + right, y + down), each +1 or
/// -1.
void CutCells::add_quarter(int x, int y, int right, int down) {
  const Vertex own = mesh_.vertex(x, y);
  if (!(own.w > 0)) return;
  const float* w = mesh_.grid.w.row(y + kFrame) + x + kFrame;
  const std::uint8_t* links = mesh_.links(x, y);
  const std::ptrdiff_t row_w = mesh_.grid.w.stride(), row_links = mesh_.grid.links.stride();
  const float along_x = 0.5F * static_cast<float>(right) * gradient(w, links, 1, 1, kRight);
  const float along_y =
      0.5F * static_cast<float>(down) * gradient(w, links, row_w, row_links, kDown);
  const glm::vec2 ray = mesh_.tof_ray.row(y)[x];
  const auto half = [&](glm::vec2 other) {
    return std::isnan(other.x) ? glm::vec2(0) : 0.5F * (other - ray);
  };
  const glm::vec2 ray_x = half(mesh_.tof_ray.row(y)[x + right]);
  const glm::vec2 ray_y = half(mesh_.tof_ray.row(y + down)[x]);
  const float reach_x = reach_.towards(x, y, right, 0), reach_y = reach_.towards(x, y, 0, down);
  const auto corner = [&](float i, float j) {
    const float corner_w = std::max(*w + i * along_x + j * along_y, kLeastCornerPart * *w);
    return project(mesh_.params, ray + i * ray_x + j * ray_y, corner_w);
  };
  const Vertex across = corner(reach_x, 0), diagonal = corner(reach_x, reach_y),
               along = corner(0, reach_y);
  if (!(across.w > 0 && diagonal.w > 0 && along.w > 0)) return;
  if (right == down)
    quads_.push({own, across, diagonal, along});
  else
    quads_.push({own, along, diagonal, across});
  if (quads_.full()) draw();
}

/// Draws the cells (x0, y) to (x1 - 1, y), at most kRunCells.
void draw_run(const Mesh& mesh, int x0, int x1, int y, const Band& band, CutCells& cut_cells,
              Image<float>& view_w) {
  const std::uint8_t* links = mesh.links(x0, y);
  const std::ptrdiff_t stride = mesh.grid.links.stride();
  alignas(64) std::array<std::int32_t, kRunCells> whole{};
  for (int i = 0; i < x1 - x0; ++i)
    whole[static_cast<std::size_t>(i)] = is_whole(links + i, stride) ? -1 : 0;
  QuadBatch quads;
  for (quads.count = 0; quads.count < x1 - x0; quads.count += kLanes)
    put_whole(mesh, x0 + quads.count, y,
              load<IntLanes>(&whole[static_cast<std::size_t>(quads.count)]),
              static_cast<std::size_t>(quads.count), quads);
  draw_quads(quads, false, band, view_w);
  for (int x = x0; x < x1; ++x)
    if (whole[static_cast<std::size_t>(x - x0)] == 0) cut_cells.add(x, y);
}

/// Finds the view rows that the known vertices of each run of cells span.
void span_row(int y, WarpScratch& out) {
  constexpr float kMax = std::numeric_limits<float>::max();
  for (int run = 0; run < out.runs; ++run) {
    const int x0 = run * kRunCells, x1 = std::min(x0 + kRunCells + 1, out.size.width);
    float v_min = kMax, v_max = -kMax;
    for (int j = y; j <= y + 1; ++j)
      for (int x = x0; x < x1; ++x) {
        const bool known = out.w.row(j)[x] > 0;
        const float v = out.v_px.row(j)[x];
        v_min = std::min(v_min, known ? v : kMax);
        v_max = std::max(v_max, known ? v : -kMax);
      }
    out.spans[static_cast<std::size_t>(y * out.runs + run)] = {v_min, v_max};
  }
}

void draw_band(const Mesh& mesh, const Band& band, float reach_px, Image<float>& view_w) {
  const WarpScratch& vertices = mesh.vertices;
  CutCells cut_cells(mesh, band, view_w);
  for (int y = 0; y + 1 < vertices.size.height; ++y)
    for (int run = 0; run < vertices.runs; ++run) {
      const auto& span = vertices.spans[static_cast<std::size_t>(y * vertices.runs + run)];
      if (!(span.v_max + reach_px >= static_cast<float>(band.y0) &&
            span.v_min - reach_px < static_cast<float>(band.y1)))
        continue;
      const int x0 = run * kRunCells, x1 = std::min(x0 + kRunCells, vertices.size.width - 1);
      draw_run(mesh, x0, x1, y, band, cut_cells, view_w);
    }
  cut_cells.draw();
}

}  // namespace

WarpScratch::WarpScratch(Size tof_size) : size(tof_size) {
  // Runs are read in whole registers, past the last vertex of a row.
  const Size padded{tof_size.width + kLanes, tof_size.height};
  u_px.reset(padded);
  v_px.reset(padded);
  w.reset(padded);
  runs = std::max(0, (tof_size.width - 2) / kRunCells + 1);
  spans.resize(static_cast<std::size_t>(runs) * static_cast<std::size_t>(tof_size.height));
}

void warp(Crew& crew, const Tables& tables, const TofGrid& grid, WarpScratch& scratch,
          Image<float>& view_w, Before before) {
  constexpr int kGrain = 32;
  const WarpParams& params = tables.warp;
  const Image<glm::vec2>& tof_ray = tables.tof_ray;
  const Size view_size = tables.view_size;
  const int width = tof_ray.width(), height = tof_ray.height();
  crew.rows(height, kGrain, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      project_row(params, tof_ray.row(y), grid.w.row(y + kFrame) + kFrame, width, y, scratch);
  });
  crew.rows(height - 1, kGrain, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) span_row(y, scratch);
  });
  const Mesh mesh{params, tof_ray, grid, scratch};
  const int band_rows = std::max(16, (view_size.height / 16 + 3) / 4 * 4);
  crew.rows(view_size.height, band_rows, [&](int begin, int end) {
    const int last_y = end == view_size.height ? end : end - 4;
    if (before == Before::kNothing)
      for (int y = begin; y < end; ++y) std::fill_n(view_w.row(y), view_w.width(), 0.0F);
    draw_band(mesh, {begin, end, view_size.width, last_y},
              1 + 0.5F * kMostReach * tables.tof_footprint_px, view_w);
  });
}

}  // namespace mixrig::render::cpu

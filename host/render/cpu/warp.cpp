// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/warp.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "host/render/cpu/simd.h"

namespace mixrig::render::cpu {
namespace {

constexpr float kNearM = 0.01F;

/// A vertex in the view; w 0: not there.
struct Vertex {
  float u, v, w;
};

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

/// The affine function through three vertices: value at (x, y) relative to the first.
struct Slope {
  float x, y;
};

/// Twice the area; positive where the triangle shows its front.
float area2(const Vertex& a, const Vertex& b, const Vertex& c) {
  return (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
}

Slope w_slope(const Vertex& a, const Vertex& b, const Vertex& c, float area) {
  const float inverse = 1 / area;
  return {((b.w - a.w) * (c.v - a.v) - (c.w - a.w) * (b.v - a.v)) * inverse,
          ((c.w - a.w) * (b.u - a.u) - (b.w - a.w) * (c.u - a.u)) * inverse};
}

/// Signed distance (times length) to the line a-b, positive inside, at (x, y) relative to `origin`.
struct Edge {
  float x, y, c;
  Edge(const Vertex& a, const Vertex& b, const Vertex& origin)
      : x(a.v - b.v), y(b.u - a.u), c(-(x * (a.u - origin.u) + y * (a.v - origin.v))) {}
  F16 at(F16 dx, F16 dy) const { return dx * x + (dy * y + c); }
};

constexpr F16 kBlockX = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
constexpr F16 kBlockY = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};

/// Raises 4x4 pixels from (x, y) to `w` where that is nearer.
void raise_block(float* at, std::ptrdiff_t stride, F16 w) {
  using F8 = float __attribute__((vector_size(32)));
  const F4 r0 = load<F4>(at), r1 = load<F4>(at + stride);
  const F4 r2 = load<F4>(at + 2 * stride), r3 = load<F4>(at + 3 * stride);
  const F8 upper = __builtin_shufflevector(r0, r1, 0, 1, 2, 3, 4, 5, 6, 7);
  const F8 lower = __builtin_shufflevector(r2, r3, 0, 1, 2, 3, 4, 5, 6, 7);
  const F16 old =
      __builtin_shufflevector(upper, lower, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  const F16 raised = old > w ? old : w;
  store(at, __builtin_shufflevector(raised, raised, 0, 1, 2, 3));
  store(at + stride, __builtin_shufflevector(raised, raised, 4, 5, 6, 7));
  store(at + 2 * stride, __builtin_shufflevector(raised, raised, 8, 9, 10, 11));
  store(at + 3 * stride, __builtin_shufflevector(raised, raised, 12, 13, 14, 15));
}

/// The view rows of a band. Blocks start at `last_y` at most, so that no band writes another's
/// rows.
struct Band {
  int y0, y1, width, last_y;
};

/// Four corners in order around; triangles a-b-c and a-c-d. `cut` marks what they draw. Both
/// include their borders: the nearest-surface test makes double coverage harmless and no crack
/// stays between neighbours.
void draw_quad(const std::array<Vertex, 4>& q, bool cut, const Band& band, Image<float>& view_w) {
  constexpr float kBorder = -1e-3F, kNever = std::numeric_limits<float>::infinity();
  const float u_min = std::min(std::min(q[0].u, q[1].u), std::min(q[2].u, q[3].u));
  const float u_max = std::max(std::max(q[0].u, q[1].u), std::max(q[2].u, q[3].u));
  const float v_min = std::min(std::min(q[0].v, q[1].v), std::min(q[2].v, q[3].v));
  const float v_max = std::max(std::max(q[0].v, q[1].v), std::max(q[2].v, q[3].v));
  if (!(u_max >= 0 && u_min < static_cast<float>(band.width))) return;
  if (!(v_max >= static_cast<float>(band.y0) && v_min < static_cast<float>(band.y1))) return;
  const int x0 = static_cast<int>(std::ceil(std::max(u_min, 0.0F)));
  const int y0 = static_cast<int>(std::ceil(std::max(v_min, static_cast<float>(band.y0))));
  const int x1 = static_cast<int>(std::min(u_max, static_cast<float>(band.width - 1)));
  const int y1 = static_cast<int>(std::min(v_max, static_cast<float>(band.y1 - 1)));

  const float area_abc = area2(q[0], q[1], q[2]), area_acd = area2(q[0], q[2], q[3]);
  const float border_abc = area_abc > 0 ? kBorder : kNever;
  const float border_acd = area_acd > 0 ? kBorder : kNever;
  const Slope abc = w_slope(q[0], q[1], q[2], area_abc), acd = w_slope(q[0], q[2], q[3], area_acd);
  const Edge ab(q[0], q[1], q[0]), bc(q[1], q[2], q[0]), cd(q[2], q[3], q[0]), da(q[3], q[0], q[0]);
  const Edge ac(q[0], q[2], q[0]);
  for (int y = y0; y <= y1; y += 4)
    for (int x = x0; x <= x1; x += 4) {
      const int top = std::min(y, band.last_y);
      const F16 dx = kBlockX + (static_cast<float>(x) - q[0].u);
      const F16 dy = kBlockY + (static_cast<float>(top) - q[0].v);
      const F16 side = ac.at(dx, dy);
      const I16 in_abc =
          (ab.at(dx, dy) >= border_abc) & (bc.at(dx, dy) >= border_abc) & (side <= -border_abc);
      const I16 in_acd =
          (cd.at(dx, dy) >= border_acd) & (da.at(dx, dy) >= border_acd) & (side >= border_acd);
      const F16 w_abc = dx * abc.x + (dy * abc.y + q[0].w);
      const F16 w_acd = dx * acd.x + (dy * acd.y + q[0].w);
      const I16 flagged = (std::bit_cast<I16>(in_acd ? w_acd : w_abc) & ~1) | (cut ? 1 : 0);
      const F16 w = std::bit_cast<F16>(flagged & (in_abc | in_acd));
      raise_block(view_w.row(top) + x, view_w.stride(), w);
    }
}

/// What a cell looks at.
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

void draw_whole(const Mesh& mesh, int x, int y, const Band& band, Image<float>& view_w) {
  const Vertex v00 = mesh.vertex(x, y), v10 = mesh.vertex(x + 1, y);
  const Vertex v01 = mesh.vertex(x, y + 1), v11 = mesh.vertex(x + 1, y + 1);
  if (!(v00.w > 0 && v10.w > 0 && v01.w > 0 && v11.w > 0)) return;
  const float* w = mesh.grid.w.row(y + kFrame) + x + kFrame;
  const float* below = w + mesh.grid.w.stride();
  const bool down_right = std::abs(w[0] - below[1]) <= std::abs(w[1] - below[0]);
  if (down_right)
    draw_quad({v00, v10, v11, v01}, false, band, view_w);
  else
    draw_quad({v10, v11, v01, v00}, false, band, view_w);
}

/// Mean change of w from a sample to the next along `d`, over the links that hold.
float gradient(const float* w, const std::uint8_t* links, std::ptrdiff_t d_w,
               std::ptrdiff_t d_links, Link link) {
  const bool ahead = links[0] & link, behind = links[-d_links] & link;
  const float sum = (ahead ? w[d_w] - w[0] : 0) + (behind ? w[0] - w[-d_w] : 0);
  return ahead && behind ? 0.5F * sum : sum;
}

/// The quarter of the cell next to vertex (x, y), towards (x + right, y + down), each +1 or -1.
void draw_quarter(const Mesh& mesh, int x, int y, int right, int down, const Band& band,
                  Image<float>& view_w) {
  const Vertex own = mesh.vertex(x, y);
  if (!(own.w > 0)) return;
  const float* w = mesh.grid.w.row(y + kFrame) + x + kFrame;
  const std::uint8_t* links = mesh.links(x, y);
  const float along_x = 0.5F * static_cast<float>(right) * gradient(w, links, 1, 1, kRight);
  const float along_y = 0.5F * static_cast<float>(down) *
                        gradient(w, links, mesh.grid.w.stride(), mesh.grid.links.stride(), kDown);
  const glm::vec2 ray = mesh.tof_ray.row(y)[x];
  const auto half = [&](glm::vec2 other) {
    return std::isnan(other.x) ? glm::vec2(0) : 0.5F * (other - ray);
  };
  const glm::vec2 ray_x = half(mesh.tof_ray.row(y)[x + right]);
  const glm::vec2 ray_y = half(mesh.tof_ray.row(y + down)[x]);
  const auto corner = [&](float i, float j) {
    const float corner_w = std::max(*w + i * along_x + j * along_y, 0.5F * *w);
    return project(mesh.params, ray + i * ray_x + j * ray_y, corner_w);
  };
  const Vertex across = corner(1, 0), diagonal = corner(1, 1), along = corner(0, 1);
  if (!(across.w > 0 && diagonal.w > 0 && along.w > 0)) return;
  if (right == down)
    draw_quad({own, across, diagonal, along}, true, band, view_w);
  else
    draw_quad({own, along, diagonal, across}, true, band, view_w);
}

bool is_whole(const std::uint8_t* links, std::ptrdiff_t stride) {
  constexpr int kFirst = kRight | kDown | kDownRight, kSecond = kDown | kDownLeft;
  return (links[0] & kFirst) == kFirst && (links[1] & kSecond) == kSecond &&
         (links[stride] & kRight);
}

void draw_cell(const Mesh& mesh, int x, int y, const Band& band, Image<float>& view_w) {
  if (is_whole(mesh.links(x, y), mesh.grid.links.stride())) {
    draw_whole(mesh, x, y, band, view_w);
    return;
  }
  draw_quarter(mesh, x, y, 1, 1, band, view_w);
  draw_quarter(mesh, x + 1, y, -1, 1, band, view_w);
  draw_quarter(mesh, x, y + 1, 1, -1, band, view_w);
  draw_quarter(mesh, x + 1, y + 1, -1, -1, band, view_w);
}

/// View rows that the known vertices of each run of cells span.
void span_row(int y, WarpScratch& out) {
  constexpr float kMax = std::numeric_limits<float>::max();
  for (int run = 0; run < out.runs; ++run) {
    const int x0 = run * kRunCells, x1 = std::min(x0 + kRunCells + 1, out.w.width());
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
  for (int y = band.y0; y < band.y1; ++y) std::fill_n(view_w.row(y), view_w.width(), 0.0F);
  const WarpScratch& vertices = mesh.vertices;
  for (int y = 0; y + 1 < vertices.w.height(); ++y)
    for (int run = 0; run < vertices.runs; ++run) {
      const auto& span = vertices.spans[static_cast<std::size_t>(y * vertices.runs + run)];
      if (!(span.v_max + reach_px >= static_cast<float>(band.y0) &&
            span.v_min - reach_px < static_cast<float>(band.y1)))
        continue;
      const int x0 = run * kRunCells, x1 = std::min(x0 + kRunCells, vertices.w.width() - 1);
      for (int x = x0; x < x1; ++x) draw_cell(mesh, x, y, band, view_w);
    }
}

}  // namespace

WarpScratch::WarpScratch(Size tof_size) {
  u_px.reset(tof_size);
  v_px.reset(tof_size);
  w.reset(tof_size);
  runs = std::max(0, (tof_size.width - 2) / kRunCells + 1);
  spans.resize(static_cast<std::size_t>(runs) * static_cast<std::size_t>(tof_size.height));
}

void warp(Crew& crew, const Tables& tables, const TofGrid& grid, WarpScratch& scratch,
          Image<float>& view_w) {
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
    draw_band(mesh, {begin, end, view_size.width, last_y}, 1 + tables.tof_footprint_px, view_w);
  });
}

}  // namespace mixrig::render::cpu

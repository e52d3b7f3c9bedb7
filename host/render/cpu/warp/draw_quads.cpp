// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/warp/draw_quads.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "host/render/cpu/simd.h"

namespace mixrig::render::cpu {
namespace {

using Floats = QuadBatch::Row;
using Ints = std::array<std::int32_t, QuadBatch::kCapacity>;

/// Function x dx + y dy + c at (dx, dy) from corner 0, of each quad.
struct alignas(64) Affines {
  Floats x, y, c;
};

/// Quads prepared for drawing.
struct alignas(64) SetUp {
  Ints x0, y0, x1, y1;            ///< pixels whose centres it may cover, inclusive
  Affines ab, bc, cd, da, ac;     ///< distance (times length) to the sides, positive inside
  Affines w_abc, w_acd;           ///< inverse depth over the triangles
  Floats border_abc, border_acd;  ///< least distance to the sides; infinite for a back face
  std::array<int, QuadBatch::kCapacity> visible;  ///< indices of the quads that reach the band
  int visible_count = 0;
};

struct VertexLanes {
  FloatLanes u, v, w;
};

template <typename Lanes, typename Row>
void put(Row& row, int first, Lanes value) {
  store(row.data() + first, value);
}

void set_side(const VertexLanes& from, const VertexLanes& to, const VertexLanes& origin, int first,
              Affines& side) {
  const FloatLanes x = from.v - to.v, y = to.u - from.u;
  put(side.x, first, x);
  put(side.y, first, y);
  put(side.c, first, -(x * (from.u - origin.u) + y * (from.v - origin.v)));
}

void set_triangle(const VertexLanes& a, const VertexLanes& b, const VertexLanes& c,
                  const VertexLanes& origin, int first, Affines& w, Floats& border) {
  constexpr float kBorder = -1e-3F, kNever = std::numeric_limits<float>::infinity();
  // Twice the area; positive where the triangle shows its front.
  const FloatLanes area = (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
  const FloatLanes inverse = 1 / area;
  put(w.x, first, ((b.w - a.w) * (c.v - a.v) - (c.w - a.w) * (b.v - a.v)) * inverse);
  put(w.y, first, ((c.w - a.w) * (b.u - a.u) - (b.w - a.w) * (c.u - a.u)) * inverse);
  put(w.c, first, origin.w);
  put(border, first, area > 0 ? FloatLanes{} + kBorder : FloatLanes{} + kNever);
}

/// Pixels whose centres lie in [low, high] and in [begin, end); if none, first > last. The range
/// stays inside for any input.
void set_range(FloatLanes low, FloatLanes high, int begin, int end, IntLanes visible, int first,
               Ints& out_first, Ints& out_last) {
  const FloatLanes least = FloatLanes{} + static_cast<float>(begin);
  const FloatLanes most = FloatLanes{} + static_cast<float>(end);
  const FloatLanes from = min(max(least, low), most), to = min(max(least, high), most - 1);
  const IntLanes floor = truncate(from);
  put(out_first, first, floor - (to_float(floor) < from));  // true is -1: rounds up
  put(out_last, first, visible ? truncate(to) : IntLanes{} - 1);
}

void set_up_lanes(const QuadBatch& quads, int first, const Band& band, SetUp& out) {
  const auto corner = [&](std::size_t i) -> VertexLanes {
    return {load<FloatLanes>(&quads.u_px[i][static_cast<std::size_t>(first)]),
            load<FloatLanes>(&quads.v_px[i][static_cast<std::size_t>(first)]),
            load<FloatLanes>(&quads.w[i][static_cast<std::size_t>(first)])};
  };
  const VertexLanes a = corner(0), b = corner(1), c = corner(2), d = corner(3);
  const FloatLanes u_min = min(min(a.u, b.u), min(c.u, d.u));
  const FloatLanes u_max = max(max(a.u, b.u), max(c.u, d.u));
  const FloatLanes v_min = min(min(a.v, b.v), min(c.v, d.v));
  const FloatLanes v_max = max(max(a.v, b.v), max(c.v, d.v));
  const IntLanes visible = (u_max >= 0) & (u_min < static_cast<float>(band.width)) &
                           (v_max >= static_cast<float>(band.y0)) &
                           (v_min < static_cast<float>(band.y1));
  set_range(u_min, u_max, 0, band.width, visible, first, out.x0, out.x1);
  set_range(v_min, v_max, band.y0, band.y1, visible, first, out.y0, out.y1);
  set_side(a, b, a, first, out.ab);
  set_side(b, c, a, first, out.bc);
  set_side(c, d, a, first, out.cd);
  set_side(d, a, a, first, out.da);
  set_side(a, c, a, first, out.ac);
  set_triangle(a, b, c, a, first, out.w_abc, out.border_abc);
  set_triangle(a, c, d, a, first, out.w_acd, out.border_acd);
}

void set_up(const QuadBatch& quads, const Band& band, SetUp& out) {
  for (int first = 0; first < quads.count; first += kLanes) set_up_lanes(quads, first, band, out);
  out.visible_count = 0;
  for (int k = 0; k < quads.count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    out.visible[static_cast<std::size_t>(out.visible_count)] = k;
    out.visible_count += (out.x0[i] <= out.x1[i]) & (out.y0[i] <= out.y1[i]);
  }
}

/// Rows of a block that fill a register; lanes hold them row by row.
constexpr int kRows = kLanes / 4;
template <int... kLane>
constexpr FloatLanes lane_x(std::integer_sequence<int, kLane...>) {
  return FloatLanes{static_cast<float>(kLane % 4)...};
}
template <int... kLane>
constexpr FloatLanes lane_y(std::integer_sequence<int, kLane...>) {
  return FloatLanes{static_cast<float>(kLane / 4)...};
}
constexpr FloatLanes kLaneX = lane_x(std::make_integer_sequence<int, kLanes>());
constexpr FloatLanes kLaneY = lane_y(std::make_integer_sequence<int, kLanes>());

/// Raises 4 x kRows pixels from `at` on to `w` where that is nearer.
template <int... kRow>
void raise(float* at, std::ptrdiff_t stride, FloatLanes w, std::integer_sequence<int, kRow...>) {
  const auto raise_row = [](float* row, F4 to) {
    const F4 old = load<F4>(row);
    store(row, old > to ? old : to);
  };
  (raise_row(at + kRow * stride,
             __builtin_shufflevector(w, w, 4 * kRow, 4 * kRow + 1, 4 * kRow + 2, 4 * kRow + 3)),
   ...);
}

/// The coefficients of one quad as scalars.
struct Plane {
  Plane(const Affines& of, std::size_t k) : x(of.x[k]), y(of.y[k]), c(of.c[k]) {}
  FloatLanes at(FloatLanes dx, FloatLanes dy) const { return dx * x + (dy * y + c); }
  float x, y, c;
};

void draw(const SetUp& s, std::size_t k, float u0, float v0, int cut, const Band& band,
          Image<float>& view_w) {
  const Plane ab(s.ab, k), bc(s.bc, k), cd(s.cd, k), da(s.da, k), ac(s.ac, k);
  const Plane w_abc(s.w_abc, k), w_acd(s.w_acd, k);
  const float border_abc = s.border_abc[k], border_acd = s.border_acd[k];
  for (int y = s.y0[k]; y <= s.y1[k]; y += 4) {
    const int top = std::min(y, band.last_y);
    const float to_top = static_cast<float>(top) - v0;
    const float last_dy = static_cast<float>(s.y1[k] - top) + to_top;
    // Rows outside, columns inside: g++ fuses a product and a sum only in the same loop body, so
    // every register width rounds alike.
    for (int row = 0; row < 4 && top + row <= s.y1[k]; row += kRows) {
      const FloatLanes dy = kLaneY + static_cast<float>(row) + to_top;
      const IntLanes in_rows = dy <= last_dy;
      for (int x = s.x0[k]; x <= s.x1[k]; x += 4) {
        const FloatLanes dx = kLaneX + (static_cast<float>(x) - u0);
        const FloatLanes side = ac.at(dx, dy);
        const IntLanes in_abc =
            (ab.at(dx, dy) >= border_abc) & (bc.at(dx, dy) >= border_abc) & (side <= -border_abc);
        const IntLanes in_acd =
            (cd.at(dx, dy) >= border_acd) & (da.at(dx, dy) >= border_acd) & (side >= border_acd);
        const FloatLanes w = in_acd ? w_acd.at(dx, dy) : w_abc.at(dx, dy);
        const IntLanes flagged = (std::bit_cast<IntLanes>(w) & ~1) | cut;
        raise(view_w.row(top + row) + x, view_w.stride(),
              std::bit_cast<FloatLanes>(flagged & in_rows & (in_abc | in_acd)),
              std::make_integer_sequence<int, kRows>());
      }
    }
  }
}

}  // namespace

void QuadBatch::push(const std::array<Vertex, 4>& corners) {
  const auto k = static_cast<std::size_t>(count++);
  for (std::size_t i = 0; i < 4; ++i) {
    u_px[i][k] = corners[i].u;
    v_px[i][k] = corners[i].v;
    w[i][k] = corners[i].w;
  }
}

void draw_quads(const QuadBatch& quads, bool cut, const Band& band, Image<float>& view_w) {
  SetUp s;
  set_up(quads, band, s);
  for (int i = 0; i < s.visible_count; ++i) {
    const auto k = static_cast<std::size_t>(s.visible[static_cast<std::size_t>(i)]);
    draw(s, k, quads.u_px[0][k], quads.v_px[0][k], cut, band, view_w);
  }
}

}  // namespace mixrig::render::cpu

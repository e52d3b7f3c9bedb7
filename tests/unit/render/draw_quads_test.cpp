// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/warp/draw_quads.h"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "host/render/cpu/warp/warp.h"

namespace mixrig::test {
namespace {

using render::cpu::Band;
using render::cpu::draw_quads;
using render::cpu::kViewMargin;
using render::cpu::QuadBatch;
using render::cpu::Vertex;
using Quad = std::array<Vertex, 4>;

constexpr Size kQuadsView{48, 40};
constexpr Band kAll{0, kQuadsView.height, kQuadsView.width, kQuadsView.height};

Image<float> empty_view() {
  return Image<float>({kQuadsView.width + kViewMargin, kQuadsView.height + kViewMargin});
}
Image<float> drawn(const std::vector<Quad>& quads, int at_once = QuadBatch::kCapacity) {
  Image<float> view_w = empty_view();
  QuadBatch batch;
  for (const Quad& quad : quads) {
    batch.push(quad);
    if (batch.count < at_once) continue;
    draw_quads(batch, false, kAll, view_w);
    batch.count = 0;
  }
  draw_quads(batch, false, kAll, view_w);
  return view_w;
}
void expect_same(const Image<float>& a, const Image<float>& b) {
  for (int y = 0; y < kQuadsView.height; ++y)
    for (int x = 0; x < kQuadsView.width; ++x) ASSERT_EQ(a.at(x, y), b.at(x, y)) << x << "," << y;
}

/// Quads of a mesh: front faces of some pixels, a few of them folded or reaching out of the view.
std::vector<Quad> random_quads(int count) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> u(-4, kQuadsView.width + 4), v(-4, kQuadsView.height + 4),
      side(0.3F, 9), bend(-0.8F, 0.8F), w(0.2F, 2);
  std::vector<Quad> quads;
  for (int i = 0; i < count; ++i) {
    const float x = u(random), y = v(random), a = side(random), b = side(random);
    Quad quad{{{x, y, 0}, {x + a, y, 0}, {x + a, y + b, 0}, {x, y + b, 0}}};
    for (Vertex& corner : quad)
      corner = {corner.u + bend(random), corner.v + bend(random), w(random)};
    quads.push_back(quad);
  }
  return quads;
}

/// Least distance of a point to the sides of a triangle, positive inside; -infinity for a back.
double depth_in(const Vertex& a, const Vertex& b, const Vertex& c, double x, double y) {
  const auto distance = [&](const Vertex& p, const Vertex& q) {
    const double du = double{q.u} - p.u, dv = double{q.v} - p.v;
    return (du * (y - p.v) - dv * (x - p.u)) / std::hypot(du, dv);
  };
  const double area2 =
      (double{b.u} - a.u) * (double{c.v} - a.v) - (double{b.v} - a.v) * (double{c.u} - a.u);
  if (area2 <= 0) return -std::numeric_limits<double>::infinity();
  return std::min({distance(a, b), distance(b, c), distance(c, a)});
}
/// Inverse depth of the triangle's plane there, by Cramer's rule.
double plane_w(const Vertex& a, const Vertex& b, const Vertex& c, double x, double y) {
  const double bu = double{b.u} - a.u, bv = double{b.v} - a.v;
  const double cu = double{c.u} - a.u, cv = double{c.v} - a.v;
  const double s = ((x - a.u) * cv - (y - a.v) * cu) / (bu * cv - bv * cu);
  const double t = ((y - a.v) * bu - (x - a.u) * bv) / (bu * cv - bv * cu);
  return a.w + s * (double{b.w} - a.w) + t * (double{c.w} - a.w);
}

TEST(DrawQuads, agree_with_double_precision_away_from_the_sides) {
  int inside = 0, outside = 0;
  for (const Quad& q : random_quads(400)) {
    const Image<float> view_w = drawn({q});
    for (int y = 0; y < kQuadsView.height; ++y)
      for (int x = 0; x < kQuadsView.width; ++x) {
        const double abc = depth_in(q[0], q[1], q[2], x, y), acd = depth_in(q[0], q[2], q[3], x, y);
        if (std::max(abc, acd) < -0.02) {
          ASSERT_EQ(view_w.at(x, y), 0) << x << "," << y;
          ++outside;
        } else if (std::abs(abc) > 0.02 && std::abs(acd) > 0.02 && (abc > 0) != (acd > 0)) {
          const double w =
              abc > 0 ? plane_w(q[0], q[1], q[2], x, y) : plane_w(q[0], q[2], q[3], x, y);
          if (!(w > 0)) continue;
          ASSERT_NEAR(view_w.at(x, y), w, 2e-4 * (1 + w)) << x << "," << y;
          ++inside;
        }
      }
  }
  EXPECT_GT(inside, 1000);
  EXPECT_GT(outside, 100000);
}

TEST(DrawQuads, any_number_at_once_draws_the_same_bits) {
  const std::vector<Quad> quads = random_quads(100);
  const Image<float> one_by_one = drawn(quads, 1);
  for (int at_once = 2; at_once <= QuadBatch::kCapacity; ++at_once)
    expect_same(drawn(quads, at_once), one_by_one);
}

TEST(DrawQuads, bands_draw_what_the_whole_view_does_and_leave_other_rows) {
  const std::vector<Quad> quads = random_quads(QuadBatch::kCapacity);
  QuadBatch batch;
  for (const Quad& quad : quads) batch.push(quad);
  const Image<float> whole = drawn(quads);
  for (int split = 4; split <= kQuadsView.height - 4; split += 3) {
    Image<float> view_w = empty_view();
    draw_quads(batch, false, {0, split, kQuadsView.width, split - 4}, view_w);
    for (int y = split; y < kQuadsView.height; ++y)
      for (int x = 0; x < kQuadsView.width; ++x) ASSERT_EQ(view_w.at(x, y), 0);
    draw_quads(batch, false, {split, kQuadsView.height, kQuadsView.width, kQuadsView.height},
               view_w);
    expect_same(view_w, whole);
  }
}

TEST(DrawQuads, neighbours_leave_no_crack_and_mark_cut_cells) {
  // A grid of cells with sides through pixel centres and between them.
  Image<float> view_w = empty_view();
  QuadBatch batch;
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) {
      const auto vertex = [](int i, int j) {
        return Vertex{3 + 2.5F * static_cast<float>(i), 2 + 3.25F * static_cast<float>(j), 0.5F};
      };
      batch.push({vertex(x, y), vertex(x + 1, y), vertex(x + 1, y + 1), vertex(x, y + 1)});
      if (!batch.full()) continue;
      draw_quads(batch, true, kAll, view_w);
      batch.count = 0;
    }
  for (int y = 2; y <= 28; ++y)
    for (int x = 3; x <= 23; ++x) {
      EXPECT_NEAR(view_w.at(x, y), 0.5F, 1e-6F) << x << "," << y;
      EXPECT_TRUE(render::cpu::from_cut_cell(view_w.at(x, y)));
    }
}

TEST(DrawQuads, rows_end_with_the_box_however_long_a_register_is) {
  // The lower side lies 1e-4 px above row 9: within the border of the sides, outside the box.
  const Image<float> view_w = drawn({{{{4, 4, 1}, {9, 4, 1}, {9, 8.9999F, 1}, {4, 8.9999F, 1}}}});
  EXPECT_NEAR(view_w.at(6, 8), 1, 1e-6F);
  EXPECT_EQ(view_w.at(6, 9), 0);
}

TEST(DrawQuads, backs_and_numbers_that_are_none_draw_nothing) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const Image<float> nothing = empty_view();
  expect_same(drawn({{{{4, 4, 1}, {4, 9, 1}, {9, 9, 1}, {9, 4, 1}}}}), nothing);
  expect_same(drawn({{{{4, 4, 1}, {4, 4, 1}, {4, 4, 1}, {4, 4, 1}}}}), nothing);
  expect_same(drawn({{{{4, 4, 1}, {9, 9, 1}, {14, 14, 1}, {6, 6, 1}}}}), nothing);
  for (const float bad : {kNan, kInfinity, -kInfinity, 3e38F, -3e38F})
    for (std::size_t corner = 0; corner < 4; ++corner) {
      Quad quad{{{4, 4, 1}, {9, 4, 1}, {9, 9, 1}, {4, 9, 1}}};
      quad[corner].u = bad;
      drawn({quad});  // stays inside the picture, which the sanitizers see
      quad[corner].v = bad;
      drawn({quad});
    }
}

}  // namespace
}  // namespace mixrig::test

// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/virtual/virtual.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <set>

#include "tests/support/resident_memory.h"
#include "tests/unit/render/helpers.h"

namespace mixrig::test {
namespace {

constexpr Size kVirtualView{32, 32};

/// One mesh in camera axes before an ideal camera of focal length 32.
struct DrawnObjects {
  DrawnObjects(std::vector<glm::vec3> positions_m, std::vector<std::uint32_t> indices,
               bool double_sided = false, std::vector<glm::vec2> uv = {},
               ImageView<const Rgb8> texture = {}, Size view = kVirtualView)
      : positions(std::move(positions_m)),
        normals(positions.size(), glm::vec3(0, 0, -1)),
        texture_uv(std::move(uv)),
        triangles(std::move(indices)),
        setup(plain_setup(view, 32, {4, 4}, 4)) {
    render::VirtualObject object;
    object.meshes.push_back(
        {positions, normals, texture_uv, triangles, glm::vec3(0.5F), texture, double_sided});
    setup.objects.push_back(object);
    render::FramePreparer preparer(setup);
    preparer.update({});
    rect = preparer.params().virtual_rect;
    Crew crew(2);
    render::cpu::VirtualScratch scratch(preparer.params(), view, crew.threads());
    layer.reset(view, false, false);
    render::cpu::draw_virtual(crew, preparer.params(), scratch, layer);
  }
  /// Pixels' worth of coverage.
  double area() const {
    double sum = 0;
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 32; ++x) sum += layer.coverage.at(x, y) / 255.0;
    return sum;
  }
  std::vector<glm::vec3> positions, normals;
  std::vector<glm::vec2> texture_uv;
  std::vector<std::uint32_t> triangles;
  render::CompositorSetup setup;
  render::Rect rect;
  render::cpu::VirtualLayer layer;
};

/// A square at z, corners at +-half, that faces the camera.
std::vector<glm::vec3> square(float half, float z) {
  return {{-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z}};
}
const std::vector<std::uint32_t> kFront = {0, 2, 1, 0, 3, 2}, kBack = {0, 1, 2, 0, 2, 3};

TEST(Virtual, square_covers_its_pixels_with_its_depth_and_albedo) {
  const DrawnObjects d(square(0.5F, 2), kFront);  // 8 px to either side of 15.5
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      const bool inside = x >= 8 && x <= 23 && y >= 8 && y <= 23;
      ASSERT_EQ(d.layer.coverage.at(x, y), inside ? 255 : 0) << x << "," << y;
      if (!inside) continue;
      EXPECT_NEAR(d.layer.w.at(x, y), 0.5F, 1e-6F);
      EXPECT_NEAR(d.layer.color.at(x, y).g, 32768, 1);
      EXPECT_EQ(d.layer.normal.at(x, y).z, -127);
    }
}

TEST(Virtual, border_inside_a_pixel_is_covered_by_halves) {
  const DrawnObjects d(square(0.53125F, 2),
                       kFront);  // 8.5 px: ends in the middle of pixels 7 and 24
  EXPECT_EQ(d.layer.coverage.at(7, 15), 128);
  EXPECT_EQ(d.layer.coverage.at(7, 7), 64);
  EXPECT_NEAR(d.layer.color.at(7, 15).r, 16384, 1);  // premultiplied
}

TEST(Virtual, an_edge_along_an_axis_has_five_levels_each_within_an_eighth_of_the_truth) {
  for (const bool along_x : {true, false}) {
    std::set<int> levels;
    for (int sixteenth = 0; sixteenth <= 16; ++sixteenth) {
      const float covered = static_cast<float>(sixteenth) / 16;  // of pixel 7
      const DrawnObjects d(square((8 + covered + 1e-4F) / 16, 2), kFront);
      const int level = along_x ? d.layer.coverage.at(7, 15) : d.layer.coverage.at(15, 7);
      EXPECT_NEAR(level / 255.0, covered, 0.127) << sixteenth;
      levels.insert(level);
    }
    EXPECT_EQ(levels.size(), 5U);
  }
}

TEST(Virtual, back_faces_are_culled_unless_double_sided) {
  EXPECT_EQ(DrawnObjects(square(0.5F, 2), kBack).area(), 0);
  const DrawnObjects both(square(0.5F, 2), kBack, true);
  EXPECT_EQ(both.area(), 256);
  EXPECT_LT(both.layer.normal.at(15, 15).z, 0) << "the normal turns to the camera";
}

TEST(Virtual, object_behind_the_camera_draws_nothing) {
  const DrawnObjects d(square(0.5F, -2), kBack, true);
  EXPECT_TRUE(d.rect.empty());
  EXPECT_EQ(d.area(), 0);
}

TEST(Virtual, floor_through_the_camera_plane_is_cut_not_mirrored) {
  // 1 m below the camera, from 5 m behind to 5 m before it, seen from above.
  const DrawnObjects d({{-9, 1, -5}, {9, 1, -5}, {9, 1, 5}, {-9, 1, 5}}, {0, 1, 2, 0, 2, 3}, true);
  for (int y = 0; y < 32; ++y) {
    // w at 1 m below, of the nearest sample: it lies 0.375 px below the middle.
    const float expected = (static_cast<float>(y) + 0.375F - 15.5F) / 32;
    EXPECT_NEAR(d.layer.w.at(16, y), expected > 0.2F ? expected : 0, 1e-5F) << y;
  }
}

TEST(Virtual, nearest_triangle_wins) {
  std::vector<glm::vec3> p = square(0.5F, 2);
  for (const glm::vec3& q : square(0.5F, 3)) p.push_back(q);
  const DrawnObjects d(p, {4, 6, 5, 4, 7, 6, 0, 2, 1, 0, 3, 2});
  EXPECT_NEAR(d.layer.w.at(15, 15), 0.5F, 1e-6F);
}

TEST(Virtual, texture_is_perspective_correct_and_repeats) {
  // Columns of light 0, 1, repeated twice over a square: four columns of 4 px, bilinear between.
  const auto texture = make_image<Rgb8>({2, 1}, [](int x, int) {
    return x ? Rgb8{255, 255, 255} : Rgb8{0, 0, 0};
  });
  const DrawnObjects d(square(0.5F, 2), kFront, false, {{0, 0}, {2, 0}, {2, 1}, {0, 1}}, texture);
  const auto at = [&](int x) { return d.layer.color.at(x, 15).r / 32767.5; };
  // u = (x - 7.5) / 8; texel centres lie at u = 0.25 and 0.75: light is linear between.
  const auto expected = [](double u) { return 1 - std::abs(2 * (u - std::floor(u)) - 1.5); };
  for (const int x : {10, 11, 12, 13, 18, 19, 20, 21})
    EXPECT_NEAR(at(x), expected((x - 7.5) / 8), 0.01) << x;
}

/// Result of one sample's ray cut with every triangle of a mesh.
struct Cut {
  double z_m = 0;            ///< 0: nothing
  bool near_border = false;  ///< of any triangle: rounding may decide
  glm::dvec3 weights{0};
  std::size_t first_index = 0;  ///< of the triangle
};
Cut cut(const DrawnObjects& d, glm::dvec3 ray) {
  Cut out;
  for (std::size_t i = 0; i + 2 < d.triangles.size(); i += 3) {
    const glm::dvec3 a(d.positions[d.triangles[i]]), b(d.positions[d.triangles[i + 1]]),
        c(d.positions[d.triangles[i + 2]]);
    const glm::dvec3 n = glm::cross(b - a, c - a);
    const double z_m = glm::dot(n, a) / glm::dot(n, ray);
    const glm::dvec3 p = ray * z_m;
    const glm::dvec3 weights =
        glm::dvec3(glm::dot(n, glm::cross(c - b, p - b)), glm::dot(n, glm::cross(a - c, p - c)),
                   glm::dot(n, glm::cross(b - a, p - a))) /
        glm::dot(n, n);
    const double least = std::min(std::min(weights.x, weights.y), weights.z);
    out.near_border |= std::abs(least) < 1e-3;
    if (!(least > 0 && z_m > 0.01) || (out.z_m > 0 && z_m >= out.z_m)) continue;
    out.z_m = z_m, out.weights = weights, out.first_index = i;
  }
  return out;
}

TEST(Virtual, many_small_triangles_agree_with_rays) {
  std::minstd_rand random(11);
  const auto between = [&](float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(random);
  };
  for (const Size view : {Size{3, 40}, Size{7, 5}, Size{33, 31}, Size{64, 20}}) {
    std::vector<glm::vec3> corners;
    std::vector<glm::vec2> uv;
    std::vector<std::uint32_t> indices;
    for (int i = 0; i < 120; ++i) {
      const glm::vec3 center(between(-1.2F, 1.2F), between(-1.2F, 1.2F), between(1, 4));
      for (int k = 0; k < 3; ++k) {
        indices.push_back(static_cast<std::uint32_t>(corners.size()));
        corners.push_back(center +
                          0.3F * glm::vec3(between(-1, 1), between(-1, 1), between(-1, 1)));
        uv.emplace_back(between(-2, 2), between(-2, 2));
      }
    }
    // A dark texel around u = 0.25 and a light one around 0.75, repeated.
    const auto texture = make_image<Rgb8>({2, 1}, [](int x, int) {
      return x ? Rgb8{255, 255, 255} : Rgb8{0, 0, 0};
    });
    const DrawnObjects d(corners, indices, true, uv, texture, view);
    int judged = 0, mixed = 0;
    for (int y = 0; y < view.height; ++y)
      for (int x = 0; x < view.width; ++x) {
        int covered = 0;
        double nearest_w = 0, light = 0;
        bool sure = true;
        std::size_t first = 0;
        for (int i = 0; i < 4; ++i) {
          constexpr double kAt_px[4][2] = {
              {-0.125, -0.375}, {0.375, -0.125}, {-0.375, 0.125}, {0.125, 0.375}};
          const Cut hit = cut(d, {(x + kAt_px[i][0] - 0.5 * (view.width - 1)) / 32,
                                  (y + kAt_px[i][1] - 0.5 * (view.height - 1)) / 32, 1});
          sure &= !hit.near_border;
          if (!(hit.z_m > 0)) continue;
          mixed += covered > 0 && hit.first_index != first;
          first = hit.first_index;
          ++covered;
          nearest_w = std::max(nearest_w, 1 / hit.z_m);
          double u = 0;
          for (int k = 0; k < 3; ++k)
            u += hit.weights[k] * d.texture_uv[d.triangles[first + static_cast<std::size_t>(k)]].x;
          const double from_dark = u - 0.25 - std::floor(u - 0.25);
          light += 0.5 * (1 - std::abs(2 * from_dark - 1));
        }
        if (!sure) continue;
        ++judged;
        ASSERT_EQ(d.layer.coverage.at(x, y), (255 * covered + 2) / 4) << x << "," << y;
        ASSERT_NEAR(d.layer.w.at(x, y), nearest_w, 1e-3) << x << "," << y;
        if (covered == 0) continue;
        double shown = d.layer.color.at(x, y).g / 65535.0;
        for (const auto& other : d.layer.others.row(y))
          if (other.x == x) shown += other.albedo.g / 65535.0;
        EXPECT_NEAR(shown, light / 4, 0.01) << x << "," << y;
      }
    EXPECT_GT(judged, static_cast<int>(view.area()) / 2);
    EXPECT_GT(mixed, view.width > 10 ? 10 : 0);
  }
}

/// Triangles at random with all that a mesh may have, drawn a register of pixels at a time or one
/// by one.
struct Drawn {
  Drawn(const render::CompositorSetup& setup, bool in_lanes) {
    render::FramePreparer preparer(setup);
    preparer.update({});
    Crew crew(1);
    const Size view = setup.view.size_px;
    render::cpu::VirtualScratch scratch(preparer.params(), view, crew.threads());
    fitting = std::count(scratch.fits.begin(), scratch.fits.end(), true);
    if (!in_lanes) scratch.fits.assign(scratch.fits.size(), false);
    layer.reset(view, true, true);
    render::cpu::draw_virtual(crew, preparer.params(), scratch, layer);
  }
  std::ptrdiff_t fitting = 0;  ///< meshes
  render::cpu::VirtualLayer layer;
};

TEST(Virtual, registers_of_pixels_show_what_single_ones_do) {
  std::minstd_rand random(5);
  const auto between = [&](float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(random);
  };
  const auto any_color = [&](int, int) {
    const auto byte = [&] { return static_cast<std::uint8_t>(between(0, 255.9F)); };
    return Rgb8{byte(), byte(), byte()};
  };
  const auto small = make_image<Rgb8>({2, 1}, any_color),
             large = make_image<Rgb8>({37, 23}, any_color);
  constexpr int kMeshes = 6, kTriangles = 40;
  std::vector<std::vector<glm::vec3>> positions(kMeshes), normals(kMeshes);
  std::vector<std::vector<glm::vec2>> uv(kMeshes);
  std::vector<std::uint32_t> indices(3 * kTriangles);
  std::iota(indices.begin(), indices.end(), 0U);
  for (const Size view : {Size{5, 30}, Size{70, 40}}) {
    render::CompositorSetup setup = plain_setup(view, 32, {4, 4}, 4);
    render::VirtualObject object;
    for (std::size_t m = 0; m < kMeshes; ++m) {
      // Texels from much larger than a pixel to much smaller, and places no texture has.
      const float repeats = m < 2 ? 0.3F : m < 4 ? 2 : 50;
      positions[m].clear(), normals[m].clear(), uv[m].clear();
      for (int i = 0; i < kTriangles; ++i) {
        const glm::vec3 center(between(-1.2F, 1.2F), between(-0.8F, 0.8F), between(0.5F, 4));
        for (int k = 0; k < 3; ++k) {
          const auto offset = [&] { return between(-0.5F, 0.5F); };
          positions[m].push_back(center + glm::vec3(offset(), offset(), offset()));
          normals[m].push_back(glm::normalize(glm::vec3(offset(), offset(), -1)));
          uv[m].emplace_back(between(-repeats, repeats), i == 7 ? 3e6F : between(-1, repeats));
        }
      }
      render::MeshView mesh{positions[m],
                            normals[m],
                            uv[m],
                            indices,
                            glm::vec3(between(0, 1), between(0, 1), 1),
                            m % 2 ? small : large,
                            m > 1};
      if (m == 3) mesh.texture = {}, mesh.uv = {};
      if (m == 4) mesh.gloss = {.metallic = 0.7F, .roughness = 0.3F, .specular = 0.5F};
      if (m == 5) mesh.emission = glm::vec3(0.2F);  // by single pixels
      object.meshes.push_back(mesh);
    }
    setup.objects.push_back(object);
    const Drawn lanes(setup, true), single(setup, false);
    ASSERT_EQ(lanes.fitting, kMeshes - 1);
    int covered = 0, far_off = 0;
    std::size_t two_surfaces = 0;
    for (int y = 0; y < view.height; ++y)
      for (int x = 0; x < view.width; ++x) {
        const auto &a = lanes.layer, &b = single.layer;
        ASSERT_EQ(a.coverage.at(x, y), b.coverage.at(x, y)) << x << "," << y;
        ASSERT_EQ(a.w.at(x, y), b.w.at(x, y)) << x << "," << y;
        if (a.coverage.at(x, y) == 0) continue;
        ++covered;
        const auto c = a.color.at(x, y), d = b.color.at(x, y);
        for (const int off : {c.r - d.r, c.g - d.g, c.b - d.b}) {
          // Where a triangle with fifty texture repeats is seen edge-on, rounding moves the sample
          // by parts of a texel.
          ASSERT_NEAR(off, 0, 655) << x << "," << y;
          far_off += std::abs(off) > 20;
        }
        const auto n = a.normal.at(x, y), o = b.normal.at(x, y);
        for (const int off : {n.x - o.x, n.y - o.y, n.z - o.z}) ASSERT_NEAR(off, 0, 1);
        const auto g = a.gloss.at(x, y), h = b.gloss.at(x, y);
        ASSERT_NEAR(g.metallic, h.metallic, 1);
        ASSERT_NEAR(g.roughness, h.roughness, 1);
        ASSERT_NEAR(g.specular, h.specular, 1);
        ASSERT_EQ(a.emission.at(x, y).g, b.emission.at(x, y).g);
        ASSERT_EQ(n.w, o.w) << "samples";
      }
    for (int y = 0; y < view.height; ++y) {
      const auto a = lanes.layer.others.row(y), b = single.layer.others.row(y);
      ASSERT_EQ(a.size(), b.size()) << y;
      two_surfaces += a.size();
      for (std::size_t i = 0; i < a.size(); ++i) {
        ASSERT_EQ(a[i].x, b[i].x);
        ASSERT_EQ(a[i].w, b[i].w);
        ASSERT_EQ(a[i].normal.w, b[i].normal.w);
        ASSERT_NEAR(a[i].albedo.g, b[i].albedo.g, 655);
        ASSERT_NEAR(a[i].gloss.roughness, b[i].gloss.roughness, 1);
        ASSERT_EQ(a[i].emission.g, b[i].emission.g);
      }
    }
    EXPECT_GT(two_surfaces, 20U);
    EXPECT_GT(covered, view.area() / 2);
    EXPECT_LT(far_off, covered / 50);
  }
}

/// A square that ends in the middle of pixel 7, before one that fills the view.
TEST(Virtual, two_surfaces_of_a_pixel_are_kept_apart) {
  std::vector<glm::vec3> corners = square(0.53125F, 2);
  for (const glm::vec3& p : square(4, 3)) corners.push_back(p);
  std::vector<std::uint32_t> indices = kFront;
  for (const std::uint32_t i : kFront) indices.push_back(4 + i);
  const DrawnObjects d(corners, indices);
  EXPECT_EQ(d.layer.coverage.at(7, 15), 255);
  EXPECT_NEAR(d.layer.w.at(7, 15), 0.5F, 1e-6F);
  EXPECT_NEAR(d.layer.color.at(7, 15).g, 16384, 1) << "of two samples";
  EXPECT_EQ(d.layer.normal.at(7, 15).w, 2 * render::cpu::kSampleShare);
  const auto others = d.layer.others.row(15);
  ASSERT_EQ(others.size(), 2U) << "pixels 7 and 24";
  EXPECT_EQ(others[0].x, 7);
  EXPECT_NEAR(others[0].w, 1.0F / 3, 1e-6F);
  EXPECT_NEAR(others[0].albedo.g, 16384, 1);
  EXPECT_EQ(others[0].normal.w, 2 * render::cpu::kSampleShare);
  EXPECT_EQ(others[1].x, 24);
}

TEST(Virtual, a_layer_takes_no_memory_where_nothing_was_drawn) {
  constexpr Size kLarge{4096, 4096};
  const double before_mb = resident_mb();
  render::cpu::VirtualLayer layer;
  render::cpu::make_layer_image(kLarge, layer.color);  // 128 MB
  EXPECT_LT(resident_mb() - before_mb, 16);
  const render::cpu::Rgbx16 none = layer.color.at(4095, 4095);
  EXPECT_EQ(none.r + none.g + none.b + none.x, 0);
}

TEST(Virtual, mesh_without_triangles_is_no_error) { EXPECT_EQ(DrawnObjects({}, {}).area(), 0); }

}  // namespace
}  // namespace mixrig::test

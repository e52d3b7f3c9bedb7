// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/virtual_pass.h"

#include "tests/gl/gl_fixture.h"
#include "tests/gl/quad_mesh.h"

namespace mixrig::test {
namespace {

using namespace render::gles;

// A point (x, y, z) lands at (16 x / z + 7.5, 16 y / z + 7.5) of 16 x 16 pixels.
constexpr render::PinholeParams kVirtualView{{16, 16}, {7.5F, 7.5F}};

class VirtualPassTest : public GlTest {
 protected:
  /// Samples of the window `rect`: two a pixel along each axis.
  void draw(const std::vector<const Quad*>& quads, render::Rect rect) {
    auto pass = VirtualPass::create();
    ASSERT_TRUE(pass) << pass.error().context;
    render::FrameParams params;
    params.virtual_rect = rect;
    std::vector<GpuMesh> meshes;
    for (const Quad* quad : quads) {
      params.draws.push_back(draw_of(*quad, kVirtualView));
      meshes.emplace_back(quad->view);
    }
    const auto drawn = pass->draw(params, meshes);
    ASSERT_TRUE(drawn) << drawn.error().context;
    albedo_ = read(pass->albedo());
    normal_ = read(pass->normal());
  }
  bool covered(int x, int y) const { return albedo_.at(x, y).a > 0.5F; }

  Image<glm::vec4> albedo_, normal_;
};

TEST_F(VirtualPassTest, covers_the_samples_inside_and_no_other) {
  // At z = 2, x from -0.4375 to 0.25: pixels 4.0 to 9.5. Samples lie at i / 2 - 0.25.
  const Quad quad({-0.4375F, -0.4375F}, {0.25F, 0.25F}, 2);
  draw({&quad}, {0, 0, 16, 16});
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      const bool inside = x >= 9 && x <= 19 && y >= 9 && y <= 19;  // 4.25 ... 9.25
      EXPECT_EQ(covered(x, y), inside) << x << "," << y;
    }
}

TEST_F(VirtualPassTest, window_starts_at_the_rectangle) {
  const Quad quad({-0.4375F, -0.4375F}, {0.25F, 0.25F}, 2);
  draw({&quad}, {4, 2, 12, 10});
  EXPECT_FALSE(covered(0, 5));  // view pixel 3.75
  EXPECT_TRUE(covered(1, 5));   // 4.25
  EXPECT_FALSE(covered(5, 4));
  EXPECT_TRUE(covered(5, 5));  // rows start at 2: 4.25 again
}

TEST_F(VirtualPassTest, nearest_surface_wins_whatever_the_order) {
  Quad near({-1, -1}, {1, 1}, 1), far({-3, -3}, {3, 3}, 3);
  near.view.base_color = {1, 0, 0};
  far.view.base_color = {0, 1, 0};
  draw({&near, &far}, {0, 0, 16, 16});
  EXPECT_EQ(albedo_.at(15, 15), glm::vec4(1, 0, 0, 1));
  draw({&far, &near}, {0, 0, 16, 16});
  EXPECT_EQ(albedo_.at(15, 15), glm::vec4(1, 0, 0, 1));
}

TEST_F(VirtualPassTest, culls_backs_unless_double_sided) {
  Quad back({-1, -1}, {1, 1}, 2, false);
  draw({&back}, {0, 0, 16, 16});
  EXPECT_FALSE(covered(15, 15));
  back.view.double_sided = true;
  draw({&back}, {0, 0, 16, 16});
  EXPECT_TRUE(covered(15, 15));
  // The normal turns to the camera: (0, 0, -1) as 0.5, 0.5, 0.
  EXPECT_NEAR(normal_.at(15, 15).z, 0, 0.01F);
  EXPECT_NEAR(normal_.at(15, 15).x, 0.5F, 0.01F);
}

TEST_F(VirtualPassTest, texture_is_filtered_in_linear_light_times_base_color) {
  const auto texture = make_image<Rgb8>({2, 1}, [](int x, int) {
    return x == 0 ? Rgb8{0, 0, 0} : Rgb8{255, 255, 255};
  });
  Quad quad({-2, -2}, {2, 2}, 2);  // u = 0..1 over pixels -8.5 to 23.5
  quad.view.texture = texture;
  quad.view.base_color = {1, 0.5F, 0};
  draw({&quad}, {0, 0, 16, 16});
  // Sample 15 lies at pixel 7.25: u = 0.4921875, texel 0.484375 of the way from black to white.
  // Linear 0.4844 is sRGB 0.7242; its half is sRGB 0.5299.
  EXPECT_NEAR(albedo_.at(15, 9).r, 0.7242F, 0.005F);
  EXPECT_NEAR(albedo_.at(15, 9).g, 0.5299F, 0.005F);
  EXPECT_EQ(albedo_.at(15, 9).b, 0);
}

TEST_F(VirtualPassTest, what_is_behind_the_camera_is_clipped) {
  Quad floor({-1, -1}, {1, 1}, 1);
  floor.positions_m = {glm::vec3(-5, 1, -5), {5, 1, -5}, {5, 1, 5}, {-5, 1, 5}};
  floor.view.double_sided = true;
  draw({&floor}, {0, 0, 16, 16});
  // Horizon at row 7.5; the far edge at 16 / 5 + 7.5 = 10.7; below it floor.
  EXPECT_FALSE(covered(16, 10));
  EXPECT_FALSE(covered(16, 21));  // pixel 10.25
  EXPECT_TRUE(covered(16, 23));   // pixel 11.25
  EXPECT_TRUE(covered(16, 31));
}

}  // namespace
}  // namespace mixrig::test

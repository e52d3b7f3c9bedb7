// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/virtual/virtual_pass.h"

#include "tests/gl/gl_fixture.h"
#include "tests/gl/quad_mesh.h"

namespace mixrig::test {
namespace {

using namespace render::gles;

// A point (x, y, z) lands at (16 x / z + 7.5, 16 y / z + 7.5) of 16 x 16 pixels.
constexpr render::PinholeParams kVirtualView{{16, 16}, {7.5F, 7.5F}};

class VirtualPassTest : public GlTest {
 protected:
  /// Draws the window `rect` with 2x2 samples per pixel.
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
    size_ = {rect.x1 - rect.x0, rect.y1 - rect.y0};
  }
  /// Whether sample i, at kAt_px from the middle of the window's pixel, is covered.
  bool covered(int x, int y, int i) const {
    return albedo_.at(x + i % 2 * size_.width, y + i / 2 * size_.height).a > 0.5F;
  }
  static constexpr float kAt_px[4][2] = {
      {-0.125F, -0.375F}, {0.375F, -0.125F}, {-0.375F, 0.125F}, {0.125F, 0.375F}};

  Size size_;
  Image<glm::vec4> albedo_, normal_;
};

TEST(VirtualSamples, of_a_view_wider_than_half_a_texture_are_refused) {
  EXPECT_TRUE(check_samples({2048, 1536}, 4096));
  const auto refused = check_samples({2560, 1440}, 4096);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kUnsupported);
  EXPECT_EQ(refused.error().context,
            "the OpenGL ES driver has textures of 4096 texels, virtual objects in a view of 2560 x "
            "1440 need 5120: use a smaller view or --backend cpu");
}

TEST_F(VirtualPassTest, covers_the_samples_inside_and_no_other) {
  // At z = 2 the edges at -0.4375 and 0.25 m are at pixels 4.0 and 9.5.
  const Quad quad({-0.4375F, -0.4375F}, {0.25F, 0.25F}, 2);
  draw({&quad}, {0, 0, 16, 16});
  const auto inside = [](float px) { return px > 4 && px < 9.5F; };
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x)
      for (int i = 0; i < 4; ++i)
        EXPECT_EQ(covered(x, y, i), inside(static_cast<float>(x) + kAt_px[i][0]) &&
                                        inside(static_cast<float>(y) + kAt_px[i][1]))
            << x << "," << y << " sample " << i;
}

TEST_F(VirtualPassTest, window_starts_at_the_rectangle) {
  const Quad quad({-0.4375F, -0.4375F}, {0.25F, 0.25F}, 2);
  draw({&quad}, {4, 2, 12, 10});
  EXPECT_FALSE(covered(0, 3, 0));  // column 3.875
  EXPECT_TRUE(covered(0, 3, 1));   // 4.375
  EXPECT_FALSE(covered(2, 2, 1));  // row 3.875
  EXPECT_TRUE(covered(2, 2, 2));   // 4.125
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
  EXPECT_FALSE(covered(7, 7, 0));
  back.view.double_sided = true;
  draw({&back}, {0, 0, 16, 16});
  EXPECT_TRUE(covered(7, 7, 0));
  // The normal is turned towards the camera: (0, 0, -1), stored as 0.5, 0.5, 0.
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
  // Sample 1 of column 7 lies at pixel 7.375: u = 0.49609375, texel 0.4921875 of the way from black
  // to white. Linear 0.4922 is sRGB 0.7294; its half is sRGB 0.5339.
  const glm::vec4 seen = albedo_.at(16 + 7, 9);
  EXPECT_NEAR(seen.r, 0.7294F, 0.005F);
  EXPECT_NEAR(seen.g, 0.5339F, 0.005F);
  EXPECT_EQ(seen.b, 0);
}

TEST_F(VirtualPassTest, what_is_behind_the_camera_is_clipped) {
  Quad floor({-1, -1}, {1, 1}, 1);
  floor.positions_m = {glm::vec3(-5, 1, -5), {5, 1, -5}, {5, 1, 5}, {-5, 1, 5}};
  floor.view.double_sided = true;
  draw({&floor}, {0, 0, 16, 16});
  // The horizon is at row 7.5, the far edge at 16 / 5 + 7.5 = 10.7; below it is floor.
  EXPECT_FALSE(covered(8, 5, 0));
  EXPECT_FALSE(covered(8, 11, 0));  // row 10.625
  EXPECT_TRUE(covered(8, 11, 1));   // row 10.875
  EXPECT_TRUE(covered(8, 15, 3));
}

}  // namespace
}  // namespace mixrig::test

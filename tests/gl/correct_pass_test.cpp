// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/plate/correct_pass.h"

#include <cmath>
#include <limits>

#include "tests/gl/gl_fixture.h"

namespace mixrig::test {
namespace {

using namespace render::gles;

constexpr Size kSize{16, 16};

class CorrectPassTest : public GlTest {
 protected:
  CorrectPassTest() {
    tables_.tof_size = kSize;
    tables_.tof_ray =
        make_image<glm::vec2>(kSize, [](int x, int y) { return (glm::vec2(x, y) - 7.5F) / 16.0F; });
    // Noise that does not change with z, and a step of 0.1 m: figures that are easy to follow.
    tables_.correct.noise = {0.001F, 0, 0};
    tables_.correct.step_min_m = 0.1F;
  }
  void draw(const Image<float>& depth_m) {
    auto pass = CorrectPass::create(tables_);
    ASSERT_TRUE(pass) << pass.error().context;
    pass->upload_depth(depth_m);
    pass->draw();
    clean_ = read(pass->clean_z_m());
    z_ = read(pass->z_m());
    vertices_ = read(pass->vertices());
  }
  int links(int x, int y) const { return static_cast<int>(vertices_.at(x, y).a); }

  render::Tables tables_;
  Image<glm::vec4> clean_, z_, vertices_;
};

TEST_F(CorrectPassTest, bad_values_are_unknown) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), kInfinity, -kInfinity, -1.0F, 0.0F, 2e4F}) {
    draw(Image<float>(kSize, bad));
    EXPECT_EQ(z_.at(3, 2).r, 0) << bad;
    EXPECT_EQ(vertices_.at(3, 2), glm::vec4(0)) << bad;
  }
  tables_.tof_ray.reset(kSize, glm::vec2(std::numeric_limits<float>::quiet_NaN()));
  draw(Image<float>(kSize, 2.0F));
  EXPECT_EQ(z_.at(3, 2).r, 0);  // the lens has no ray there
}

TEST_F(CorrectPassTest, distance_becomes_z) {
  tables_.correct.depth_is_distance = true;
  tables_.tof_ray.reset(kSize, {0.75F, 0});
  draw(Image<float>(kSize, 2.0F));
  EXPECT_NEAR(z_.at(5, 5).r, 1.6F, 1e-6F);  // 2 / sqrt(1 + 0.5625)
  EXPECT_NEAR(vertices_.at(5, 5).r, 0.625F, 1e-6F);
}

TEST_F(CorrectPassTest, flying_pixel_goes_to_the_surface_that_fills_it) {
  // Columns 0..6 at 1 m, 8.. at 3 m, one flying pixel between. At 2.0 m half of the phase is of
  // either, but the near surface is 9 times as bright for its share: 0.5 x 1 < 0.5 x 9, far.
  Image<float> depth = make_image<float>(kSize, [](int x, int) { return x < 8 ? 1.0F : 3.0F; });
  for (int y = 0; y < kSize.height; ++y) depth.at(7, y) = 2.0F;
  depth.at(7, 12) = 1.15F;  // t = 0.925: 0.925 x 1 > 0.075 x 9, near
  draw(depth);
  EXPECT_EQ(clean_.at(7, 5).r, 3.0F);
  EXPECT_EQ(clean_.at(7, 12).r, 1.0F);
  EXPECT_EQ(clean_.at(6, 5).r, 1.0F);
  EXPECT_EQ(clean_.at(8, 5).r, 3.0F);
}

TEST_F(CorrectPassTest, lonely_pixel_becomes_the_median_around_it) {
  Image<float> depth(kSize, 2.0F);
  depth.at(5, 5) = 3.5F;  // a spike
  depth.at(10, 5) = 0;    // a hole
  for (int x = 0; x < 3; ++x)
    for (int y = 10; y < 16; ++y) depth.at(x, y) = 0;  // nothing to go by at (0, 12)
  depth.at(11, 11) = 1.9F, depth.at(12, 11) = 1.95F;   // ascending: 1.9, 1.95, 2 ...
  depth.at(11, 12) = 0;
  draw(depth);
  EXPECT_EQ(clean_.at(5, 5).r, 2.0F);
  EXPECT_EQ(clean_.at(10, 5).r, 2.0F);
  EXPECT_EQ(clean_.at(0, 12).r, 0.0F);
  EXPECT_EQ(clean_.at(11, 12).r, 2.0F);
}

TEST_F(CorrectPassTest, samples_of_one_surface_are_smoothed_and_steps_stay) {
  Image<float> depth = make_image<float>(kSize, [](int x, int) { return x < 8 ? 2.0F : 3.0F; });
  depth.at(3, 3) = 2.05F;
  draw(depth);
  EXPECT_NEAR(1 / z_.at(3, 3).r, (8 * 0.5F + 1 / 2.05F) / 9, 1e-6F);
  EXPECT_NEAR(1 / z_.at(4, 4).r, (8 * 0.5F + 1 / 2.05F) / 9, 1e-6F);
  EXPECT_NEAR(z_.at(7, 9).r, 2, 1e-6F);
  EXPECT_NEAR(z_.at(8, 9).r, 3, 1e-6F);
}

TEST_F(CorrectPassTest, noise_found_in_the_picture_widens_the_step) {
  // A wall at 3 m whose samples scatter over 0.2 m, far above the declared 1 mm.
  const Image<float> wall = make_image<float>(kSize, [](int x, int y) {
    return 3 + 0.2F * static_cast<float>(((x * x + 3) * 17 + y * y * 29 + x * y * 13) % 7) / 6;
  });
  const auto whole = [&] {
    int count = 0;
    for (int y = 2; y < 14; ++y)
      for (int x = 2; x < 14; ++x) count += links(x, y) == 15;
    return count;
  };
  draw(wall);
  const int adapted = whole();
  tables_.correct.step_bends = 0;
  draw(wall);
  EXPECT_GT(adapted, 140);  // of 144
  EXPECT_LT(whole(), adapted / 2);
}

TEST_F(CorrectPassTest, links_hold_on_a_surface_and_not_over_a_step) {
  draw(make_image<float>(kSize, [](int x, int) { return x < 8 ? 1.0F : 3.0F; }));
  EXPECT_EQ(links(4, 4), 15);
  EXPECT_EQ(links(7, 4), 2 + 8);      // down and down-left: the step is to the right
  EXPECT_EQ(links(8, 4), 1 + 2 + 4);  // not down-left
  EXPECT_EQ(links(15, 4), 2 + 8);     // the picture ends
  EXPECT_EQ(links(4, 15), 1);
}

/// w falls by 0.01 a pixel: neighbours lie 0.1 m and more apart.
float grazing_m(int x) { return 1 / (0.32F - 0.01F * static_cast<float>(x)); }

TEST_F(CorrectPassTest, grazing_plane_stays_linked_by_its_inverse_depth) {
  draw(make_image<float>(kSize, [](int x, int) { return grazing_m(x); }));
  EXPECT_EQ(links(10, 5), 15);
  EXPECT_NEAR(vertices_.at(8, 5).r, 0.24F, 1e-5F);
  EXPECT_NEAR(vertices_.at(8, 5).g, -0.01F, 1e-5F);
  EXPECT_NEAR(vertices_.at(8, 5).b, 0, 1e-6F);
}

TEST_F(CorrectPassTest, slope_uses_the_links_that_hold) {
  draw(make_image<float>(kSize, [](int x, int) { return x < 8 ? grazing_m(x) : 8.0F; }));
  EXPECT_NEAR(vertices_.at(6, 5).g, -0.01F, 1e-5F);  // the next sample is the surface's last
  EXPECT_NEAR(vertices_.at(8, 5).g, 0, 1e-6F);
}

TEST_F(CorrectPassTest, a_sample_between_two_surfaces_is_no_plane) {
  tables_.correct.step_min_m = 0.2F;
  draw(make_image<float>(kSize, [](int x, int) { return x < 8 ? 3.5F : x == 8 ? 3.65F : 3.9F; }));
  EXPECT_EQ(links(7, 5), 15);     // within a step
  EXPECT_EQ(links(8, 5), 2 + 8);  // in line with the near surface, not with the far one
}

}  // namespace
}  // namespace mixrig::test

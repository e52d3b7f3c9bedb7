// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/warp/warp_pass.h"

#include <algorithm>
#include <cmath>

#include "host/render/gles/plate/correct_pass.h"
#include "tests/gl/gl_fixture.h"

namespace mixrig::test {
namespace {

using namespace render::gles;

// ToF pixel x looks along ray (x - 3.5) / 8; without translation it lands at u = 4 x + 1.5.
constexpr Size kWarpTof{8, 8}, kWarpView{32, 32};

class WarpPassTest : public GlTest {
 protected:
  WarpPassTest() {
    tables_.tof_size = kWarpTof;
    tables_.view_size = kWarpView;
    tables_.tof_ray = make_image<glm::vec2>(
        kWarpTof, [](int x, int y) { return (glm::vec2(x, y) - 3.5F) / 8.0F; });
    tables_.warp.view = {{32, 32}, {15.5F, 15.5F}};
  }
  Image<glm::vec4> draw(const Image<float>& depth_m, const Texture* plate = nullptr) {
    auto correct = CorrectPass::create(tables_);
    auto warp = WarpPass::create(tables_);
    EXPECT_TRUE(correct && warp);
    correct->upload_depth(depth_m);
    correct->draw();
    warp->draw(correct->vertices(), correct->tof_ray(), correct->raw_z_m(), plate);
    return read(warp->w());
  }

  render::Tables tables_;
};

TEST_F(WarpPassTest, plane_fills_what_the_tof_camera_sees_and_nothing_else) {
  const auto w = draw(Image<float>(kWarpTof, 2.0F));
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      const bool inside = x >= 2 && x <= 29 && y >= 2 && y <= 29;
      EXPECT_NEAR(w.at(x, y).r, inside ? 0.5F : 0.0F, 1e-6F) << x << "," << y;
    }
}

TEST_F(WarpPassTest, tilted_plane_is_exact) {
  tables_.correct.step_min_m = 10;  // one surface
  const auto plane = [](glm::vec2 ray) { return 0.5F + 0.2F * ray.x - 0.1F * ray.y; };
  const auto w = draw(make_image<float>(
      kWarpTof, [&](int x, int y) { return 1 / plane(tables_.tof_ray.at(x, y)); }));
  float worst = 0;
  // Outermost samples are smoothed with their inner neighbours only.
  for (int y = 6; y < 26; ++y)
    for (int x = 6; x < 26; ++x)
      worst = std::max(worst, std::abs(w.at(x, y).r - plane((glm::vec2(x, y) - 15.5F) / 32.0F)));
  EXPECT_LT(worst, 1e-5F);
}

TEST_F(WarpPassTest, step_lies_half_a_tof_pixel_past_the_samples) {
  const auto w = draw(make_image<float>(kWarpTof, [](int x, int) { return x < 4 ? 2.0F : 1.0F; }));
  // Samples 3 and 4 land at 13.5 and 17.5: each owns two view pixels of the cut cell.
  EXPECT_NEAR(w.at(13, 15).r, 0.5F, 1e-6F);
  EXPECT_NEAR(w.at(14, 15).r, -0.5F, 1e-6F);  // negative: a cut cell drew it
  EXPECT_NEAR(w.at(15, 15).r, -0.5F, 1e-6F);
  EXPECT_NEAR(w.at(16, 15).r, -1.0F, 1e-6F);
  EXPECT_NEAR(w.at(17, 15).r, -1.0F, 1e-6F);
  EXPECT_NEAR(w.at(18, 15).r, 1.0F, 1e-6F);
}

TEST_F(WarpPassTest, pole_of_one_sample_keeps_its_width) {
  const auto w = draw(make_image<float>(kWarpTof, [](int x, int) { return x == 4 ? 1.0F : 3.0F; }));
  int width = 0;
  for (int x = 0; x < 32; ++x) width += std::abs(w.at(x, 15).r) > 0.9F;
  EXPECT_EQ(width, 4);
}

TEST_F(WarpPassTest, nearest_surface_wins_and_gaps_stay_unknown) {
  // The ToF camera stands 0.25 m to the left: a point at z moves right by 32 x 0.25 / z.
  tables_.warp.camera_from_tof[3] = glm::vec4(0.25F, 0, 0, 1);
  const auto w = draw(make_image<float>(kWarpTof, [](int x, int) { return x < 4 ? 1.0F : 4.0F; }));
  // Near half ends at 13.5 + 1.2 x 2 + 8 = 23.9, far half starts at 15.5 + 2 = 17.5: near covers
  // it.
  EXPECT_NEAR(std::abs(w.at(23, 15).r), 1.0F, 1e-6F);
  EXPECT_NEAR(std::abs(w.at(24, 15).r), 0.25F, 1e-6F);
  tables_.warp.camera_from_tof[3] = glm::vec4(-0.25F, 0, 0, 1);
  const auto gap =
      draw(make_image<float>(kWarpTof, [](int x, int) { return x < 4 ? 1.0F : 4.0F; }));
  // Near half ends at 13.5 + 0.2 x 2 - 8 = 5.9, far half starts at 13.5: the camera saw nothing
  // between.
  EXPECT_NEAR(std::abs(gap.at(5, 15).r), 1.0F, 1e-6F);
  for (int x = 6; x <= 13; ++x) EXPECT_EQ(gap.at(x, 15).r, 0) << x;
  EXPECT_NEAR(std::abs(gap.at(14, 15).r), 0.25F, 1e-6F);
}

TEST_F(WarpPassTest, border_lies_where_pixels_of_both_surfaces_say) {
  const auto last_near = [&](float third_m, float fourth_m) {
    const auto w = draw(make_image<float>(kWarpTof, [&](int x, int) {
      if (x == 3) return third_m;
      return x == 4 ? fourth_m : x < 4 ? 2.0F : 4.0F;
    }));
    int x = 31;
    while (x > 0 && std::abs(w.at(x, 15).r) < 0.4F) --x;
    EXPECT_NEAR(std::abs(w.at(x + 1, 15).r), 0.25F, 1e-3F) << third_m << " " << fourth_m;
    return x;
  };
  // Midway lies at 15.5; half of a ToF pixel is 2 px.
  EXPECT_EQ(last_near(2.4F, 4), 13);
  EXPECT_EQ(last_near(2, 2.4F), 17);
  EXPECT_EQ(last_near(0, 4), 13);
  EXPECT_EQ(last_near(2, 0), 17);
  EXPECT_EQ(last_near(2, 3), 16);  // 0.2 of the pixel: 0.8 px
}

TEST_F(WarpPassTest, border_lies_where_the_plate_changes) {
  // Midway lies at 15.5, and the column that saw both surfaces tells nothing.
  for (const int from : {15, 16, 17, 18, 19}) {
    const Texture plate = make_texture(
        make_image<Rgbf>(kWarpView,
                         [&](int x, int) {
                           return x < from ? Rgbf{0.3F, 0.1F, 0.05F} : Rgbf{0.35F, 0.4F, 0.45F};
                         })
            .view(),
        GL_RGB32F);
    const auto depth = make_image<float>(kWarpTof, [](int x, int) {
      return x < 4 ? 2.0F : x == 4 ? 0.0F : 4.0F;
    });
    const auto w = draw(depth, &plate);
    int x = 31;
    while (x > 0 && std::abs(w.at(x, 15).r) < 0.4F) --x;
    EXPECT_EQ(x, from - 1);
  }
}

TEST_F(WarpPassTest, border_lies_where_red_meets_cyan) {
  const Rgbf red{0.6F, 0.02F, 0.02F}, cyan{0.02F, 0.6F, 0.6F}, both{0.31F, 0.31F, 0.31F};
  const auto depth = make_image<float>(kWarpTof, [](int x, int) { return x < 4 ? 2.0F : 4.0F; });
  const auto last_near_column = [&](int mixed) {
    const Texture plate = make_texture(
        make_image<Rgbf>(kWarpView,
                         [&](int x, int) { return x < mixed    ? red
                                                  : x == mixed ? both
                                                               : cyan; })
            .view(),
        GL_RGB32F);
    const auto w = draw(depth, &plate);
    int x = 31;
    while (x > 0 && std::abs(w.at(x, 15).r) < 0.4F) --x;
    return x;
  };
  EXPECT_GE(last_near_column(18) - last_near_column(15), 2);  // of 3
}

TEST_F(WarpPassTest, unknown_samples_and_points_behind_the_camera_draw_nothing) {
  tables_.warp.camera_from_tof[3] = glm::vec4(0, 0, -2, 1);
  const auto w = draw(make_image<float>(kWarpTof, [](int x, int y) {
    return y < 4 ? 1.0F : x < 4 ? 0.0F : 3.0F;
  }));
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      const float value = std::abs(w.at(x, y).r);
      EXPECT_TRUE(value == 0 || std::abs(value - 1) < 1e-5F) << value;
    }
  EXPECT_EQ(w.at(8, 25).r, 0);
  EXPECT_NEAR(std::abs(w.at(28, 28).r), 1, 1e-5F);
}

}  // namespace
}  // namespace mixrig::test

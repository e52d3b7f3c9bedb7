// SPDX-License-Identifier: Apache-2.0
// Whole frames on the analytic scene and on small hand-made ones, by the back end of this program.
#include <cmath>

#include "tests/support/analytic_scene.h"
#include "tests/unit/render/back_end.h"
#include "tests/unit/render/helpers.h"

namespace mixrig::test {
namespace {

constexpr Size kFrameView{64, 64};

/// A grey wall at 4 m with its background known, and a virtual square at `object_m`.
struct Stage {
  explicit Stage(float object_m)
      : setup(plain_setup(kFrameView, 64, {32, 32}, 32)),
        background_m(kFrameView, 4),
        color(kFrameView, {0.2159F, 0.2159F, 0.2159F}),
        color_sigma(kFrameView, 0.01F),
        plate(kFrameView, {128, 128, 128}),
        depth({32, 32}, 4) {
    setup.background = {background_m, {}, color, color_sigma};
    const float h = 0.25F * object_m;  // 16 px to either side
    positions = {{-h, -h, object_m}, {h, -h, object_m}, {h, h, object_m}, {-h, h, object_m}};
    normals.assign(4, {0, 0, -1});
    triangles = {0, 2, 1, 0, 3, 2};
    render::VirtualObject object;
    object.meshes.push_back({positions, normals, {}, triangles, glm::vec3(1, 0, 0), {}, false});
    setup.objects.push_back(object);
    setup.light.ambient = Eigen::Vector3f::Constant(1);
  }
  /// A blue person over the left half of the view.
  void add_person(float z_m) {
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 16; ++x) depth.at(x, y) = z_m;
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 32; ++x) plate.at(x, y) = {20, 20, 200};
  }
  render::FrameOutput compose(int threads = 2) {
    render::FrameOutput out;
    out.wanted = render::kAll;
    EXPECT_TRUE(make_compositor(setup, threads)->compose({plate, depth, {}}, out));
    return out;
  }
  render::CompositorSetup setup;
  Image<float> background_m;
  Image<Rgbf> color;
  Image<float> color_sigma;
  Image<Rgb8> plate;
  Image<float> depth;
  std::vector<glm::vec3> positions, normals;
  std::vector<std::uint32_t> triangles;
};

constexpr Rgb8 kWallColor{128, 128, 128}, kPersonColor{20, 20, 200}, kObjectColor{255, 0, 0};
constexpr auto kVirtualLayer = static_cast<std::uint8_t>(render::Layer::kVirtual);
constexpr auto kPersonLayer = static_cast<std::uint8_t>(render::Layer::kPerson);

TEST(Compositor, object_hides_a_person_behind_it) {
  Stage stage(2);
  stage.add_person(3);
  const auto out = stage.compose();
  EXPECT_EQ(out.color.at(20, 32), kObjectColor);
  EXPECT_EQ(out.color.at(40, 32), kObjectColor);
  EXPECT_EQ(out.color.at(8, 32), kPersonColor);
  EXPECT_EQ(out.color.at(60, 32), kWallColor);
  EXPECT_NEAR(out.mixed_depth_m.at(20, 32), 2, 1e-4);
  EXPECT_NEAR(out.segmented_depth_m.at(20, 32), 3, 1e-3) << "the person is still segmented";
  EXPECT_EQ(out.layer.at(20, 32), kVirtualLayer);
}

TEST(Compositor, person_before_the_object_hides_it) {
  Stage stage(3);
  stage.add_person(2);
  const auto out = stage.compose();
  EXPECT_EQ(out.color.at(20, 32), kPersonColor);
  EXPECT_EQ(out.color.at(40, 32), kObjectColor);
  EXPECT_NEAR(out.mixed_depth_m.at(20, 32), 2, 1e-3);
  EXPECT_NEAR(out.mixed_depth_m.at(40, 32), 3, 1e-3);
  EXPECT_NEAR(out.mixed_depth_m.at(60, 32), 4, 1e-3);
  EXPECT_EQ(out.layer.at(20, 32), kPersonLayer);
  EXPECT_EQ(out.segmented_depth_m.at(60, 32), 0);
}

TEST(Compositor, an_object_has_a_pixel_that_it_covers_by_more_than_half) {
  const auto moved_by_px = [](float px) {
    Stage stage(2);
    for (glm::vec3& p : stage.positions) p.x += px * 2 / 64;
    return stage.compose();
  };
  // The borders of the object run through the middles of the pixels in columns 16 and 48.
  const auto half = moved_by_px(0.5F);
  for (const int x : {16, 48}) {
    EXPECT_NE(half.color.at(x, 32), kWallColor) << "its colour is there all the same";
    EXPECT_NE(half.layer.at(x, 32), kVirtualLayer);
    EXPECT_NEAR(half.mixed_depth_m.at(x, 32), 4, 1e-3);
  }
  // ...and a quarter of a pixel beyond.
  const auto more = moved_by_px(0.75F);
  EXPECT_EQ(more.layer.at(48, 32), kVirtualLayer);
  EXPECT_NEAR(more.mixed_depth_m.at(48, 32), 2, 1e-4);
  EXPECT_NE(more.layer.at(16, 32), kVirtualLayer);
}

/// A soft border in the plate, with another share of the person in each pixel and each frame.
TEST(Compositor, a_pixel_half_a_person_before_an_object_shows_no_wall) {
  constexpr int kFrames = 8;
  int half = 0;
  for (int frame = 0; frame < kFrames; ++frame) {
    Stage stage(3);
    stage.add_person(2);
    for (int y = 0; y < 64; ++y)
      for (int x = 31; x < 34; ++x) {
        const int step = (3 * y + x - 31) * kFrames + frame;
        const float share = static_cast<float>(step) / (192 * kFrames);
        const auto mixed = [&](int person) {
          return static_cast<std::uint8_t>(128 + share * (static_cast<float>(person) - 128));
        };
        stage.plate.at(x, y) = {mixed(20), mixed(20), mixed(200)};
      }
    const auto out = stage.compose();
    for (int y = 20; y < 44; ++y)
      for (int x = 20; x < 44; ++x) {
        half += out.matte.at(x, y) >= 125 && out.matte.at(x, y) < 128;
        EXPECT_NE(out.layer.at(x, y), 0) << x << "," << y << " matte " << int{out.matte.at(x, y)};
        EXPECT_LT(out.mixed_depth_m.at(x, y), 3.01F) << x << "," << y;
      }
  }
  EXPECT_GT(half, 0);
}

TEST(Compositor, object_behind_the_wall_is_not_seen_and_one_that_touches_it_is) {
  EXPECT_EQ(Stage(4.5F).compose().color.at(32, 32), kWallColor);
  EXPECT_EQ(Stage(4.01F).compose().color.at(32, 32), kObjectColor);
}

TEST(Compositor, unknown_depth_never_occludes) {
  Stage stage(3);
  stage.setup.background = {};
  stage.depth.fill(0);
  EXPECT_EQ(stage.compose().color.at(32, 32), kObjectColor);
}

TEST(Compositor, without_a_background_measured_depth_occludes) {
  Stage stage(3);
  stage.setup.background = {};
  stage.depth.fill(2);
  EXPECT_EQ(stage.compose().color.at(32, 32), kWallColor);
}

TEST(Compositor, objects_behind_or_around_the_camera_do_no_harm) {
  EXPECT_EQ(Stage(-2).compose().color.at(32, 32), kWallColor);
  EXPECT_EQ(Stage(0).compose().color.at(32, 32), kWallColor);
  EXPECT_EQ(Stage(0.001F).compose().color.at(32, 32), kWallColor) << "nearer than is drawn";
}

TEST(Compositor, empty_scene_shows_the_plate_through_the_lens) {
  Stage stage(2);
  stage.setup.objects.clear();
  stage.setup.target.lens = geometry::Lens({-0.1, 0.02, 0, 0, 0, 0, 0, 0});
  const auto out = stage.compose();
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) EXPECT_EQ(out.color.at(x, y), kWallColor);
}

TEST(Compositor, shadow_lies_on_the_wall_opposite_to_the_lamp) {
  Stage stage(2);
  stage.setup.light.ambient = Eigen::Vector3f::Constant(0.2F);
  stage.setup.light.lamps.push_back({{-2, 0, 0}, std::nullopt, {0, 0}, {3, 3, 3}});
  const auto out = stage.compose();
  // From x = -2 past the square's border at 0.5 m, z = 2 m to the wall: 3 m at z = 4 m is out of
  // view; past -0.5 m it is 1 m. The shadow begins at column 31.5 + 64 * 1 / 4.
  EXPECT_LT(out.light.at(56, 32), 0.9F);
  EXPECT_EQ(out.light.at(4, 32), 1.0F);
  EXPECT_LT(out.color.at(56, 32).r, 128);
  EXPECT_EQ(out.color.at(4, 32), kWallColor);
}

TEST(Compositor, person_takes_the_light_of_where_it_stands) {
  // A person stands before the shadow volume: the shadow behind is masked.
  Stage stage(2);
  stage.setup.light.ambient = Eigen::Vector3f::Constant(0.2F);
  stage.setup.light.lamps.push_back({{-2, 0, 0}, std::nullopt, {0, 0}, {3, 3, 3}});
  for (int y = 0; y < 32; ++y)
    for (int x = 25; x < 32; ++x) stage.depth.at(x, y) = 1.2F;
  for (int y = 0; y < 64; ++y)
    for (int x = 50; x < 64; ++x) stage.plate.at(x, y) = kPersonColor;
  const auto out = stage.compose();
  EXPECT_EQ(out.light.at(58, 32), 1.0F);
  EXPECT_EQ(out.color.at(58, 32), kPersonColor);
}

TEST(Compositor, view_and_pictures_of_one_pixel) {
  render::CompositorSetup setup = plain_setup({1, 1}, 1, {1, 1}, 1);
  render::FrameOutput out;
  out.wanted = render::kAll;
  const Image<Rgb8> plate({1, 1}, Rgb8{9, 8, 7});
  const Image<float> depth({1, 1}, 1.0F);
  ASSERT_TRUE(make_compositor(setup, 2)->compose({plate, depth, {}}, out));
  EXPECT_EQ(out.color.at(0, 0), (Rgb8{9, 8, 7}));
}

TEST(Compositor, wrong_sizes_and_setups_are_one_line) {
  Stage stage(2);
  const auto compositor = make_compositor(stage.setup, 1);
  render::FrameOutput out;
  const Image<float> small({31, 32});
  const auto wrong = compositor->compose({stage.plate, small, {}}, out);
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().code, ErrorCode::kData);
  EXPECT_NE(wrong.error().context.find("31 x 32"), std::string::npos);
  geometry::Pose nowhere;
  nowhere.translation_m.x() = std::nan("");
  EXPECT_FALSE(compositor->compose({stage.plate, stage.depth, nowhere}, out));
  stage.triangles[0] = 99;
  EXPECT_FALSE(render::validate(stage.setup));
  stage.triangles[0] = 0;
  stage.setup.light.lamps.push_back({{0, 0, std::nan("")}, std::nullopt, {0, 0}, {1, 1, 1}});
  EXPECT_FALSE(render::validate(stage.setup));
}

/// The small exact world: what the whole chain makes of a noisy ToF picture.
struct World {
  World() {
    scene.person_x_m = -0.1;
    const Camera target{{320, 144}, 300, {0, 0, 0}, 0}, tof{{432, 192}, 365, {-0.07, 0.01, 0}, 0};
    AnalyticScene empty = scene;
    empty.person = false;
    setup = plain_setup(target.size_px, target.f_px, tof.size_px, tof.f_px);
    setup.target_from_tof.translation_m = tof.position_m;
    render_truth(scene, target, truth_m, person);
    render_truth(empty, target, background_m, nobody);
    seen = seen_by_tof(scene, target, tof, truth_m);
    setup.background.depth_m = background_m;
    plate = render_plate(scene, target, 1);
    depth = render_tof(scene, tof, 2, 0.008);
  }
  AnalyticScene scene;
  render::CompositorSetup setup;
  Image<float> truth_m, background_m, depth;
  Image<std::uint8_t> person, nobody, seen;
  Image<Rgb8> plate;
};

TEST(Compositor, warp_and_key_of_an_exact_world_are_right) {
  const World world;
  render::FrameOutput out;
  out.wanted = render::kAll;
  ASSERT_TRUE(make_compositor(world.setup, 2)->compose({world.plate, world.depth, {}}, out));
  int judged = 0, bad = 0, pole = 0, pole_found = 0, both = 0, either = 0;
  for (int y = 0; y < 144; ++y)
    for (int x = 0; x < 320; ++x) {
      const bool keyed = out.matte.at(x, y) >= 128, truly = world.person.at(x, y) > 0;
      both += keyed && truly;
      either += keyed || truly;
      if (!world.seen.at(x, y)) continue;
      const float z = out.warped_depth_m.at(x, y), truth = world.truth_m.at(x, y);
      const bool wrong = !(z > 0) || std::abs(z - truth) > 0.1F;
      ++judged;
      bad += wrong;
      const bool on_pole = std::abs(truth - 3) < 0.05F && x > 240 && x < 262;
      pole += on_pole;
      pole_found += on_pole && !wrong;
    }
  EXPECT_LT(bad, 0.012 * judged);
  EXPECT_GT(pole, 200) << "24 mm at 3 m";
  EXPECT_GT(pole_found, 0.8 * pole);
  EXPECT_GT(both, 0.92 * either) << "by depth alone";
}

TEST(Compositor, threads_do_not_change_a_bit) {
  const World world;
  render::FrameOutput one, three;
  for (auto [threads, out] : {std::pair{1, &one}, {3, &three}})
    ASSERT_TRUE(
        make_compositor(world.setup, threads)->compose({world.plate, world.depth, {}}, *out));
  for (int y = 0; y < 144; ++y)
    for (int x = 0; x < 320; ++x) {
      ASSERT_EQ(one.color.at(x, y), three.color.at(x, y));
      ASSERT_EQ(one.matte.at(x, y), three.matte.at(x, y));
      ASSERT_EQ(one.mixed_depth_m.at(x, y), three.mixed_depth_m.at(x, y));
    }
}

}  // namespace
}  // namespace mixrig::test

// SPDX-License-Identifier: Apache-2.0
// The capture volume alone keys, and the room behind it may be replaced (Cortes Reina 2015).
#include <cmath>

#include "host/render/cpu/compositor_cpu.h"
#include "host/render/cpu/key/key.h"
#include "host/render/cpu/light/people_shadow.h"
#include "host/render/cpu/light/visibility.h"
#include "tests/unit/render/helpers.h"

namespace mixrig::test {
namespace {

constexpr Size kVolumeView{64, 64};
constexpr double kEye_m = 1.5;
const Rgbf kFloorColor{0.5F, 0.5F, 0.5F}, kShirt{0.6F, 0.1F, 0.1F};

/// A camera 1.5 m over the floor z = 0 that looks along world x; its pictures are set by hand.
struct OnFloor {
  OnFloor()
      : setup(plain_setup(kVolumeView, 64, {32, 32}, 32)),
        plate(kVolumeView, linear16(kFloorColor)) {
    setup.capture_box = render::CaptureBox{{1, -2, 0}, {5, 2, 3}};
    pose.translation_m = {0, 0, kEye_m};
    Eigen::Matrix3d axes;  // columns: right, down, forward
    axes.col(0) = -Eigen::Vector3d::UnitY();
    axes.col(1) = -Eigen::Vector3d::UnitZ();
    axes.col(2) = Eigen::Vector3d::UnitX();
    pose.rotation = Eigen::Quaterniond(axes);
    w.reset({kVolumeView.width + 3, kVolumeView.height + 3}, 1 / 9.0F);
    for (int y = 0; y < kVolumeView.height; ++y)
      for (int x = 0; x < kVolumeView.width; ++x) w.at(x, y) = std::max(floor_w(y), 1 / 9.0F);
  }
  /// The room ends 9 m away.
  static float floor_w(int y, double height_m = 0) {
    return static_cast<float>((y - 31.5) / 64 / (kEye_m - height_m));
  }
  void put(int x0, int y0, int x1, int y1, float z_m, bool color = true) {
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) {
        w.at(x, y) = 1 / z_m;
        if (color) plate.at(x, y) = linear16(kShirt);
      }
  }
  void run(bool use_color = false) {
    setup.key.color = use_color;
    const render::Tables tables = render::make_tables(setup);
    render::FramePreparer preparer(setup);
    preparer.update(pose);
    render::cpu::KeyScratch scratch(kVolumeView, tables.tof_footprint_px, 2);
    matte.reset(kVolumeView, 77);
    Crew crew(2);
    render::cpu::key(crew, {tables, preparer.params().key, setup.background, plate}, scratch, w,
                     matte);
  }
  int people() const {
    int n = 0;
    for (int y = 0; y < kVolumeView.height; ++y)
      for (int x = 0; x < kVolumeView.width; ++x) n += matte.at(x, y) >= 128;
    return n;
  }
  render::CompositorSetup setup;
  geometry::Pose pose;
  Image<float> w;
  Image<render::cpu::Rgbx16> plate;
  Image<std::uint8_t> matte;
};

TEST(Volume, noise_of_the_floor_shows_nobody) {
  OnFloor scene;
  const render::NoiseParams noise = render::noise_params(scene.setup.noise);
  for (int y = 0; y < kVolumeView.height; ++y)
    for (int x = 0; x < kVolumeView.width; ++x) {
      const float z = 1 / scene.w.at(x, y);
      scene.w.at(x, y) = 1 / (z + ((x + y) % 2 == 0 ? 3.5F : -3.5F) * noise.sigma_m(z));
    }
  scene.run();
  EXPECT_EQ(scene.people(), 0);
}

TEST(Volume, who_stands_in_it_is_keyed_down_to_the_floor) {
  OnFloor scene;
  scene.put(24, 16, 40, 62, 3.2F);  // row 62 is the floor 3.2 m away
  scene.run();
  // Depth votes round corners off, and the last row lies within the floor's tolerance.
  for (int y = 0; y < kVolumeView.height; ++y)
    for (int x = 0; x < kVolumeView.width; ++x) {
      if (x >= 26 && x < 38 && y >= 18 && y < 59) {
        EXPECT_GE(scene.matte.at(x, y), 128) << x << ' ' << y;
      }
      if (x < 23 || x >= 41 || y < 15 || y >= 63) {
        EXPECT_EQ(scene.matte.at(x, y), 0) << x << ' ' << y;
      }
    }
}

TEST(Volume, who_stands_outside_is_not) {
  OnFloor behind, beside;
  behind.put(24, 16, 40, 45, 6);
  behind.run();
  EXPECT_EQ(behind.people(), 0);
  beside.setup.capture_box->min_m.y = 1;  // to the left of the picture's middle
  beside.put(36, 16, 52, 60, 3);
  beside.run();
  EXPECT_EQ(beside.people(), 0);
}

TEST(Volume, floor_is_what_lies_within_the_tolerance) {
  for (const double height_m : {0.01, 0.4}) {
    OnFloor scene;
    for (int y = 52; y < 63; ++y)
      for (int x = 20; x < 44; ++x) scene.w.at(x, y) = OnFloor::floor_w(y, height_m);
    scene.run();
    EXPECT_EQ(scene.people() > 0, height_m > 0.1) << height_m;
  }
}

TEST(Volume, colours_around_decide_where_depth_reaches_over_the_border) {
  OnFloor scene;
  scene.put(24, 16, 40, 60, 3.2F);
  for (int y = 16; y < 60; ++y)  // depth reaches two pixels too far
    for (int x = 40; x < 42; ++x) scene.w.at(x, y) = 1 / 3.2F;
  OnFloor by_depth = scene;
  by_depth.run(false);
  EXPECT_GE(by_depth.matte.at(41, 30), 128);
  scene.run(true);
  EXPECT_LT(scene.matte.at(41, 30), 128);
  EXPECT_GE(scene.matte.at(38, 30), 128);
}

TEST(Volume, a_camera_below_the_floor_does_no_harm) {
  OnFloor scene;
  scene.pose.translation_m.z() = -1;
  scene.run();
  EXPECT_EQ(scene.people(), 0);  // all of it lies below the box
}

/// A wall at 4 m behind the capture volume, a person at 2 m at the left, an object at 3 m before
/// both halves of the picture's middle.
struct Replaced {
  Replaced()
      : setup(plain_setup(kVolumeView, 64, {32, 32}, 32)),
        plate(kVolumeView, kGrey),
        depth({32, 32}, 4) {
    setup.capture_box = render::CaptureBox{{-9, -9, 0.5}, {9, 9, 3.5}};
    setup.capture_box->floor_tolerance_m = 0;
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 16; ++x) depth.at(x, y) = 2;
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 32; ++x) plate.at(x, y) = kBlue;
    const float h = 0.75F;
    positions = {{-h, -h, 3}, {h, -h, 3}, {h, h, 3}, {-h, h, 3}};
    normals.assign(4, {0, 0, -1});
    triangles = {0, 2, 1, 0, 3, 2};
    render::VirtualObject object;
    object.meshes.push_back({positions, normals, {}, triangles, glm::vec3(1, 0, 0), {}, false});
    setup.objects.push_back(object);
    setup.light.ambient = Eigen::Vector3f::Constant(1);
    setup.backdrop.emplace();
  }
  render::FrameOutput compose() {
    render::FrameOutput out;
    out.wanted = render::kAll;
    auto compositor = render::make_cpu_compositor(setup, 2);
    EXPECT_TRUE(compositor) << compositor.error().context;
    if (compositor) {
      EXPECT_TRUE((*compositor)->compose({plate, depth, {}}, out));
    }
    return out;
  }
  static constexpr Rgb8 kGrey{128, 128, 128}, kBlue{20, 20, 200}, kRed{255, 0, 0};
  render::CompositorSetup setup;
  Image<Rgb8> plate;
  Image<float> depth;
  std::vector<glm::vec3> positions, normals;
  std::vector<std::uint32_t> triangles;
};

TEST(Set, nothing_of_the_room_is_left) {
  const render::FrameOutput out = Replaced().compose();
  EXPECT_EQ(out.color.at(8, 8), Replaced::kBlue);    // the person
  EXPECT_EQ(out.color.at(24, 32), Replaced::kBlue);  // before the object
  EXPECT_EQ(out.color.at(44, 32), Replaced::kRed);   // the object before the wall
  EXPECT_EQ(out.color.at(60, 32), (Rgb8{0, 0, 0}));  // the wall
  EXPECT_EQ(out.alpha.at(60, 32), 0);
  EXPECT_EQ(out.alpha.at(44, 32), 255);
  EXPECT_EQ(out.alpha.at(8, 8), 255);
  EXPECT_EQ(out.mixed_depth_m.at(60, 32), 0);
  EXPECT_NEAR(out.mixed_depth_m.at(44, 32), 3, 1e-3);
  EXPECT_NEAR(out.mixed_depth_m.at(8, 8), 2, 0.02);
}

TEST(Set, an_object_before_the_person_hides_it) {
  Replaced scene;
  for (glm::vec3& p : scene.positions) p *= 0.5F;  // at 1.5 m
  const render::FrameOutput out = scene.compose();
  EXPECT_EQ(out.color.at(24, 32), Replaced::kRed);
  EXPECT_EQ(out.color.at(8, 32), Replaced::kBlue);
}

TEST(Set, an_object_behind_the_wall_is_seen) {
  Replaced scene;
  for (glm::vec3& p : scene.positions) p *= 3;  // at 9 m
  EXPECT_EQ(scene.compose().color.at(44, 32), Replaced::kRed);
}

TEST(Set, a_picture_lies_behind_everything) {
  Replaced scene;
  const Image<Rgb8> picture(kVolumeView, {0, 200, 0});
  scene.setup.backdrop->picture = picture;
  const render::FrameOutput out = scene.compose();
  EXPECT_EQ(out.color.at(60, 32), (Rgb8{0, 200, 0}));
  EXPECT_EQ(out.color.at(44, 32), Replaced::kRed);
  EXPECT_EQ(out.color.at(8, 8), Replaced::kBlue);
  EXPECT_EQ(out.alpha.at(60, 32), 255);
}

/// Over black, a pixel of colour c and alpha a holds a c: nothing of the room shines through.
TEST(Set, borders_of_people_keep_nothing_of_the_room) {
  Replaced scene;
  scene.setup.objects.clear();
  for (int y = 0; y < 64; ++y)  // a pixel half person, half wall, in linear light
    scene.plate.at(32, y) = {94, 94, 170};
  const render::FrameOutput out = scene.compose();
  for (int y = 16; y < 48; ++y)
    for (int x = 0; x < 64; ++x) {
      const Rgb8 c = out.color.at(x, y);
      EXPECT_LE(c.r, 94 + 2) << x << ' ' << y;  // the wall has 128
      if (out.alpha.at(x, y) == 0) {
        EXPECT_EQ(c, (Rgb8{0, 0, 0})) << x << ' ' << y;
      }
    }
}

TEST(Set, open_walls_hide_nothing_and_closed_ones_do) {
  for (const bool open : {false, true}) {
    Replaced scene;
    scene.setup.backdrop.reset();
    scene.setup.open_walls = open;
    for (glm::vec3& p : scene.positions) p *= 3;  // at 9 m, behind the wall at 4 m
    const render::FrameOutput out = scene.compose();
    EXPECT_EQ(out.color.at(44, 32), open ? Replaced::kRed : Replaced::kGrey);
    EXPECT_EQ(out.color.at(24, 32), Replaced::kBlue);
  }
}

TEST(Set, wrong_ones_are_one_line) {
  Replaced without_key;
  without_key.setup.capture_box.reset();
  auto made = render::make_cpu_compositor(without_key.setup, 1);
  ASSERT_FALSE(made);
  EXPECT_NE(made.error().context.find("capture volume"), std::string::npos);
  Replaced small;
  const Image<Rgb8> picture({8, 8});
  small.setup.backdrop->picture = picture;
  made = render::make_cpu_compositor(small.setup, 1);
  ASSERT_FALSE(made);
  EXPECT_NE(made.error().context.find("8 x 8"), std::string::npos);
}

/// A person 160 px wide, 2 m before a camera of 320 px focal length: 1 m. The lamp stands at the
/// camera's left.
struct Standing {
  Standing() : setup(plain_setup({320, 240}, 320, {64, 48}, 64)) {
    setup.capture_box = render::CaptureBox{{-2, -2, 1}, {2, 2, 6}};
    setup.people_cast_shadows = true;
    geometry::Lamp lamp;
    lamp.position_m = {0, 0, 0};
    setup.light.lamps.push_back(lamp);
    positions = {{-9, -9, 8}, {9, -9, 8}, {9, 9, 8}};
    normals.assign(3, {0, 0, -1});
    triangles = {0, 2, 1};
    render::VirtualObject wall;
    wall.meshes.push_back({positions, normals, {}, triangles, glm::vec3(1), {}, true});
    wall.casts_shadow = false;
    setup.objects.push_back(wall);
    w.reset({323, 243}, 0);
    matte.reset({320, 240}, 0);
    for (int y = 40; y < 200; ++y)
      for (int x = 80; x < 240; ++x) w.at(x, y) = 0.5F, matte.at(x, y) = 255;
  }
  void draw() {
    preparer.emplace(setup);
    preparer->update({});
    people = render::cpu::PeopleShadow({320, 240});
    Crew crew(2);
    const render::PinholeParams view{glm::vec2(320, 320), glm::vec2(159.5F, 119.5F)};
    render::cpu::draw_people_maps(crew, preparer->params(), view, w, matte, people);
  }
  /// Share of the lamp that a point on the wall sees.
  float seen(float x_m, float y_m, float z_m) const {
    render::cpu::VectorLanes p{}, n{};
    p.x += x_m, p.y += y_m, p.z += z_m, n.z -= 1.0F;
    return render::cpu::visibility(people.lamps[0], people.maps[0], p, n)[0];
  }
  render::CompositorSetup setup;
  std::vector<glm::vec3> positions, normals;
  std::vector<std::uint32_t> triangles;
  Image<float> w;
  Image<std::uint8_t> matte;
  std::optional<render::FramePreparer> preparer;
  render::cpu::PeopleShadow people;
};

TEST(PeopleShadow, a_person_is_as_thick_as_the_silhouette_is_wide) {
  Standing person;
  person.draw();
  const auto ball = [&](int bx, int by) {
    return person.people.balls[static_cast<std::size_t>(by * 40 + bx)];
  };
  EXPECT_EQ(ball(9, 15).radius_m, 0);                     // beside the person
  EXPECT_NEAR(ball(10, 15).radius_m, 0.71 * 0.05, 1e-4);  // its first block of 8 px, 5 cm wide
  EXPECT_NEAR(ball(11, 15).radius_m, 1.5 * 0.05, 1e-4);
  EXPECT_NEAR(ball(20, 15).radius_m, render::kPeopleRadiusM, 1e-4);
  // The surface stays where it was measured, its middle lies behind.
  EXPECT_NEAR(glm::length(ball(20, 15).center_m) - ball(20, 15).radius_m,
              2 * std::sqrt(1 + std::pow(4.0 / 320, 2) * 2), 0.01);
}

TEST(PeopleShadow, falls_where_the_person_stands_before_the_lamp) {
  Standing person;
  person.draw();
  // Seen from the camera, the silhouette spans +-0.25 of z; so it does from a lamp at the camera.
  for (const float u : {-0.2F, 0.0F, 0.2F}) EXPECT_EQ(person.seen(8 * u, 0, 8), 0) << u;
  for (const float u : {-0.32F, 0.32F}) EXPECT_EQ(person.seen(8 * u, 0, 8), 1) << u;
  EXPECT_EQ(person.seen(0, 0, 1.5F), 1);  // before the person
}

TEST(PeopleShadow, darkens_a_virtual_surface_and_leaves_no_trace) {
  Replaced scene;
  scene.setup.people_cast_shadows = true;
  scene.setup.light.ambient = Eigen::Vector3f::Constant(0.2F);
  geometry::Lamp lamp;
  lamp.position_m = {-2, 0, 0};
  lamp.intensity.setConstant(5);
  scene.setup.light.lamps.push_back(lamp);
  auto compositor = render::make_cpu_compositor(scene.setup, 2);
  ASSERT_TRUE(compositor);
  render::FrameOutput shadowed, free;
  const Image<float> nobody({32, 32}, 4);
  ASSERT_TRUE((*compositor)->compose({scene.plate, nobody, {}}, free));
  ASSERT_TRUE((*compositor)->compose({scene.plate, scene.depth, {}}, shadowed));
  // The person's border at (0, 2 m): its shadow from (-2, 0) reaches x = 1 at 3 m.
  EXPECT_LT(shadowed.color.at(40, 32).r, free.color.at(40, 32).r - 30);
  const Image<Rgb8> before = free.color;
  ASSERT_TRUE((*compositor)->compose({scene.plate, nobody, {}}, free));
  EXPECT_EQ(free.color.at(40, 32), before.at(40, 32));
}

/// Of many lamps, only the first ones are checked for people; the others light as before.
TEST(PeopleShadow, more_lamps_than_are_looked_up_do_no_harm) {
  Replaced scene;
  scene.setup.people_cast_shadows = true;
  geometry::Lamp lamp;
  lamp.position_m = {-2, 0, 0};
  lamp.intensity.setConstant(0.05F);
  scene.setup.light.lamps.assign(70, lamp);
  const Rgb8 shadowed = scene.compose().color.at(40, 32);
  scene.depth.fill(4);
  const Rgb8 free = scene.compose().color.at(40, 32);
  EXPECT_GT(shadowed.r, 0);
  EXPECT_LE(shadowed.r, free.r);
}

}  // namespace
}  // namespace mixrig::test

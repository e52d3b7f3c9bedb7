// SPDX-License-Identifier: Apache-2.0
// The background model drawn at other poses, against a scene that is ray-cast there.
#include "host/render/cpu/background/background.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "hal/base/srgb.h"
#include "host/render/cpu/compositor_cpu.h"
#include "tests/support/analytic_scene.h"
#include "tests/support/count_allocations.h"
#include "tests/support/face_model.h"
#include "tests/unit/render/helpers.h"

namespace mixrig::test {
namespace {

constexpr Size kPannedView{320, 256}, kPannedTof{128, 106};
constexpr double kView_f_px = 260, kTof_f_px = 104;

Camera camera_at(const Eigen::Vector3d& position_m) {
  return {kPannedView, kView_f_px, position_m};
}

/// A model of the room without people from the origin, and a compositor's setup with it.
struct Modelled {
  explicit Modelled(AnalyticScene room = {}) : scene(room) {
    scene.person = false;
    setup = plain_setup(kPannedView, kView_f_px, kPannedTof, kTof_f_px);
    Image<std::uint8_t> person;
    render_truth(scene, camera_at({0, 0, 0}), depth_m, person);
    const Image<Rgb8> plate = render_plate(scene, camera_at({0, 0, 0}), 1);
    color.reset(kPannedView);
    for (int y = 0; y < kPannedView.height; ++y)
      for (int x = 0; x < kPannedView.width; ++x) {
        const Rgb8 p = plate.at(x, y);
        const auto& linear = linear_of_srgb_bytes();
        color.at(x, y) = {linear[p.r], linear[p.g], linear[p.b]};
      }
    color_sigma.reset(kPannedView, 0.01F);
    learned = learned_colors(color, color_sigma);
    setup.background_models = {{setup.view, {geometry::Pose()}, depth_m, {}, learned}};
  }
  AnalyticScene scene;
  render::CompositorSetup setup;
  Image<float> depth_m, color_sigma;
  Image<Rgbf> color;
  Image<Rgbx8> learned;
};

/// The model drawn at a pose.
struct DrawnBackground {
  DrawnBackground(const Modelled& m, const geometry::Pose& world_from_camera, int threads = 2)
      : crew(threads), tables(render::make_tables(m.setup)), background(crew, m.setup) {
    tables.key_limit_w.reset(kPannedView);
    tables.background_normal.reset(kPannedView);
    background.draw(crew, world_from_camera, tables);
    constexpr int kColumns = render::cpu::MovingBackground::kMostColumns;
    for (int y = 0; y < kPannedView.height; ++y)
      for (int x = 0; x < kPannedView.width; x += kColumns) {
        const int width = std::min(kColumns, kPannedView.width - x);
        background.draw_color(x, y, width);
        background.normals(x, y,
                           {tables.background_normal.row(y) + x, static_cast<std::size_t>(width)});
      }
  }
  Crew crew;
  render::Tables tables;
  render::cpu::MovingBackground background;
};

geometry::Pose moved(const Eigen::Vector3d& to_m) { return {Eigen::Quaterniond::Identity(), to_m}; }

struct Depths {
  int known = 0, near = 0, all = 0;  ///< within 2 % of the truth
  double color_error = 0;            ///< mean absolute difference of the known colours, linear
  int colored = 0;
};

Depths compare(const Modelled& m, const DrawnBackground& drawn, const Eigen::Vector3d& at_m) {
  Image<float> truth_m;
  Image<std::uint8_t> person;
  render_truth(m.scene, camera_at(at_m), truth_m, person);
  const Image<Rgb8> plate = render_plate(m.scene, camera_at(at_m), 2);
  const auto view = drawn.background.view();
  Depths d;
  for (int y = 0; y < kPannedView.height; ++y)
    for (int x = 0; x < kPannedView.width; ++x) {
      const float z = view.depth_m.row(y)[x], truth = truth_m.at(x, y);
      if (!(truth > 0)) continue;
      ++d.all;
      if (!(z > 0)) continue;
      ++d.known;
      d.near += std::abs(z - truth) < 0.02F * truth;
      const Rgbf c = view.color.row(y)[x];
      if (c.r < 0) continue;
      const Rgb8 p = plate.at(x, y);
      const auto& linear = linear_of_srgb_bytes();
      d.color_error += std::abs(c.g - linear[p.g]);
      ++d.colored;
    }
  EXPECT_GT(d.colored, 0.8 * d.known);
  d.color_error /= std::max(1, d.colored);
  return d;
}

TEST(Background, AtItsOwnPoseIsTheModel) {
  const Modelled m;
  const DrawnBackground drawn(m, {});
  const Depths d = compare(m, drawn, {0, 0, 0});
  EXPECT_GT(d.known, 0.999 * d.all);
  EXPECT_GT(d.near, 0.985 * d.known);
  EXPECT_LT(d.color_error, 0.01);
}

TEST(Background, ColoursOfEveryFewPixelsAndOfPicturesAreThoseOfAll) {
  const Modelled m;
  const geometry::Pose pose = moved({0.3, 0, 0});
  const DrawnBackground all(m, pose);
  DrawnBackground few(m, pose);
  render::cpu::MovingBackground picture(few.crew, m.setup, render::cpu::DrawnFor::kPictures);
  picture.draw(few.crew, pose);
  const int y = 100, x0 = 3, step = 7, count = 40;
  few.background.draw(few.crew, geometry::Pose(), few.tables);
  few.background.draw_color(0, y, 1);
  few.background.draw(few.crew, pose, few.tables);
  few.background.draw_color(x0, y, count, step);
  std::array<Rgbf, render::cpu::MovingBackground::kMostColumns> colors;
  picture.colors(0, y, colors);
  const auto view = all.background.view();
  for (int i = 0; i < count; ++i) {
    const Rgbf one = few.background.view().color.row(y)[x0 + i * step];
    EXPECT_NEAR(one.g, view.color.row(y)[x0 + i * step].g, 1e-3) << i;
  }
  for (int x = 0; x < static_cast<int>(colors.size()); ++x) {
    EXPECT_EQ(colors[static_cast<std::size_t>(x)].g, view.color.row(y)[x].g) << x;
    EXPECT_EQ(picture.view().depth_m.row(y)[x], view.depth_m.row(y)[x]) << x;
  }
}

TEST(Background, FromAnotherPlaceAgreesWithTheRayCastScene) {
  const Modelled m;
  for (const Eigen::Vector3d& at : {Eigen::Vector3d(0.3, 0, 0), Eigen::Vector3d(-0.2, 0.1, 0.25)}) {
    const DrawnBackground drawn(m, moved(at));
    const Depths d = compare(m, drawn, at);
    EXPECT_GT(d.known, 0.85 * d.all) << at.transpose();
    EXPECT_GT(d.near, 0.97 * d.known) << at.transpose();
    EXPECT_LT(d.color_error, 0.02) << at.transpose();
  }
}

TEST(Background, WhatTheModelNeverSawIsUnknown) {
  const Modelled m;
  // Half of the field of view to the right: the left half is covered.
  const geometry::Pose turned{
      Eigen::Quaterniond(Eigen::AngleAxisd(std::atan(160 / kView_f_px), Eigen::Vector3d::UnitY())),
      {0, 0, 0}};
  const DrawnBackground drawn(m, turned);
  const auto view = drawn.background.view();
  int known_left = 0, known_right = 0;
  for (int y = 100; y < 156; ++y)
    for (int x = 0; x < kPannedView.width; ++x)
      (x < 150 ? known_left : known_right) +=
          view.depth_m.row(y)[x] > 0 && x != 150 && !(x > 150 && x < 170);
  EXPECT_GT(known_left, 0.95 * 150 * 56);
  EXPECT_EQ(known_right, 0);
  EXPECT_LT(view.color.row(128)[300].r, 0);
  EXPECT_TRUE(std::isinf(drawn.tables.key_limit_w.at(300, 128)));
}

/// Surfaces that a nearer one hid from the model have no depth, and not the nearer one's colour.
TEST(Background, NoSurfaceSpansADepthStep) {
  AnalyticScene room;
  room.box = false;
  room.pole_radius_m = 0.25;
  const Modelled m(room);
  const Eigen::Vector3d at(0.6, 0, 0);
  const DrawnBackground drawn(m, moved(at));
  Image<float> truth_m;
  Image<std::uint8_t> person;
  render_truth(m.scene, camera_at(at), truth_m, person);
  int between = 0;
  for (int y = 40; y < 200; ++y)
    for (int x = 0; x < kPannedView.width; ++x) {
      const float z = drawn.background.view().depth_m.row(y)[x];
      between += z > 3.2F && z < 4.2F && truth_m.at(x, y) > 4.4F;
    }
  EXPECT_LT(between, 160 * 3) << "pixels between pole and wall";
}

/// Two faces in place of the model's one view.
TEST(Background, SeveralFacesAreOneRoom) {
  Modelled m;
  for (const int color_factor : {1, 2, 3}) {
    const FaceModel faces(m.scene, color_factor);
    m.setup.background_models = {faces.model()};
    for (const Eigen::Vector3d& at : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(-0.2, 0.1, 0.25)}) {
      const DrawnBackground drawn(m, moved(at));
      const Depths d = compare(m, drawn, at);
      EXPECT_GT(d.known, 0.93 * d.all) << at.transpose();
      EXPECT_GT(d.near, 0.96 * d.known) << at.transpose();
      EXPECT_LT(d.color_error, 0.02) << at.transpose();
    }
  }
}

/// Seen from two places, a room hides less from the camera between and beside them.
TEST(Background, WhatOneModelDidNotSeeAnotherOneShows) {
  AnalyticScene room;
  room.pole_radius_m = 0.25;
  Modelled m(room);
  const FaceModel left(m.scene, 2, {-0.5, 0, 0}), right(m.scene, 1, {0.5, 0.1, 0});
  const Eigen::Vector3d at(0.2, 0.05, 0.1);
  const auto drawn_of = [&](std::vector<render::BackgroundModel> models) {
    m.setup.background_models = std::move(models);
    const DrawnBackground drawn(m, moved(at));
    return compare(m, drawn, at);
  };
  const Depths one = drawn_of({left.model()}), other = drawn_of({right.model()});
  const Depths both = drawn_of({left.model(), right.model()});
  const Depths swapped = drawn_of({right.model(), left.model()});
  EXPECT_GT(both.colored, std::max(one.colored, other.colored) + 0.01 * both.all);
  EXPECT_GT(both.known, 0.99 * both.all);
  EXPECT_GT(both.near, 0.96 * both.known);
  EXPECT_LT(both.color_error, 0.02);
  EXPECT_NEAR(swapped.colored, both.colored, 0.001 * both.all);
  EXPECT_NEAR(swapped.color_error, both.color_error, 0.0005);
}

TEST(Background, NormalsOfSeveralModelsAreInAxesOfTheCamera) {
  Modelled m;
  const FaceModel left(m.scene, 2, {-0.4, 0, 0}), right(m.scene, 2, {0.4, 0, 0});
  m.setup.background_models = {left.model(), right.model()};
  const geometry::Pose turned{Eigen::Quaterniond(Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitY())),
                              {0, 0, 0}};
  const DrawnBackground drawn(m, turned);
  const Eigen::Vector3d expected = turned.rotation.inverse() * -Eigen::Vector3d::UnitZ();
  for (const int x : {60, 110, 160}) {  // of the back wall
    const auto n = drawn.tables.background_normal.at(x, 110);
    EXPECT_NEAR(n.x, 127 * expected.x(), 5) << x;
    EXPECT_NEAR(n.y, 127 * expected.y(), 5) << x;
    EXPECT_NEAR(n.z, 127 * expected.z(), 5) << x;
  }
}

/// Surface points of a face that lie in the view.
int points_in_view(const render::BackgroundModel& model, std::size_t face,
                   const geometry::Pose& world_from_camera) {
  const int rows = model.camera.size_px.height, top = static_cast<int>(face) * rows;
  int count = 0;
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < model.camera.size_px.width; ++x) {
      const double z_m = model.depth_m.row(top + y)[x];
      const Eigen::Vector3d ray((x - model.camera.cx_px) / model.camera.fx_px,
                                (y - model.camera.cy_px) / model.camera.fy_px, 1);
      const Eigen::Vector3d p =
          world_from_camera.rotation.inverse() *
          (model.world_from_face[face] * (z_m * ray) - world_from_camera.translation_m);
      const double u = 160 + kView_f_px * p.x() / p.z(), v = 128 + kView_f_px * p.y() / p.z();
      count += z_m > 0 && p.z() > 0 && u >= 0 && v >= 0 && u <= kPannedView.width &&
               v <= kPannedView.height;
    }
  return count;
}

TEST(Background, FacesWithoutASurfaceInTheViewAreLeftOut) {
  Modelled m;
  const FaceModel faces(m.scene);
  m.setup.background_models = {faces.model()};
  const render::BackgroundModel& model = m.setup.background_models.front();
  const render::ModelTables tables = render::make_model_tables(m.setup, model, false);
  int left_out = 0, empty = 0;
  for (int step = -8; step <= 8; ++step) {
    const geometry::Pose turned{
        Eigen::Quaterniond(Eigen::AngleAxisd(0.2 * step, Eigen::Vector3d::UnitY())),
        {0.1 * step, 0.05, 0}};
    for (const std::size_t face : {0U, 1U}) {
      const bool shows =
          render::may_show(tables, face, render::face_pose(model.world_from_face[face], turned));
      const int points = points_in_view(model, face, turned);
      left_out += !shows, empty += points == 0;
      EXPECT_TRUE(shows || points == 0) << step << " " << face;
    }
  }
  EXPECT_GT(empty, 10);
  EXPECT_GE(left_out, empty - 4) << "what is empty is seldom drawn";
}

TEST(Background, MoreModelsThanThereIsRoomForAreRefused) {
  Modelled m;
  const FaceModel faces(m.scene);
  m.setup.background_models.assign(5, faces.model());
  const auto compositor = render::make_cpu_compositor(m.setup, 1);
  ASSERT_FALSE(compositor);
  EXPECT_NE(compositor.error().context.find("5 background models"), std::string::npos);
}

TEST(Background, NormalsOfAllFacesAreInAxesOfTheCamera) {
  Modelled m;
  const FaceModel faces(m.scene);
  m.setup.background_models = {faces.model()};
  const DrawnBackground drawn(m, {});
  // The normals of the back wall, left and right of the middle.
  for (const int x : {110, 210}) {
    const auto n = drawn.tables.background_normal.at(x, 110);
    EXPECT_NEAR(n.x, 0, 5) << x;
    EXPECT_NEAR(n.y, 0, 5) << x;
    EXPECT_NEAR(n.z, -127, 5) << x;
  }
}

TEST(Background, FacesThatDoNotFitTheirPicturesAreRefused) {
  const AnalyticScene scene;
  const FaceModel faces(scene);
  const auto refusal = [&](auto&& change) {
    Modelled m;
    m.setup.background_models = {faces.model()};
    change(m.setup.background_models.front());
    const auto compositor = render::make_cpu_compositor(m.setup, 1);
    return compositor ? std::string("accepted") : compositor.error().context;
  };
  using Model = render::BackgroundModel;
  EXPECT_NE(refusal([](Model& m) { m.world_from_face.clear(); }).find("0 faces"),
            std::string::npos);
  EXPECT_NE(refusal([](Model& m) { m.world_from_face.resize(7); }).find("7 faces"),
            std::string::npos);
  EXPECT_NE(refusal([](Model& m) { m.world_from_face.pop_back(); }).find("depth"),
            std::string::npos);
  EXPECT_NE(refusal([](Model& m) { m.color_factor = 1; }).find("colour"), std::string::npos);
  EXPECT_NE(refusal([](Model& m) { m.color_factor = 9; }).find("9 times"), std::string::npos);
  EXPECT_EQ(refusal([](Model&) {}), "accepted");
}

TEST(Background, LimitAndNormalsAreThoseOfAStillBackgroundAtTheSamePose) {
  const Modelled m;
  const DrawnBackground drawn(m, {});
  render::CompositorSetup still = m.setup;
  still.background_models.clear();
  still.background = {m.depth_m, {}, m.color, m.color_sigma};
  const render::Tables tables = render::make_tables(still);
  std::vector<float> limit_error;
  int other_normals = 0;
  for (int y = 8; y < kPannedView.height - 8; ++y)
    for (int x = 8; x < kPannedView.width - 8; ++x) {
      limit_error.push_back(
          std::abs(drawn.tables.key_limit_w.at(x, y) / tables.key_limit_w.at(x, y) - 1));
      const auto a = drawn.tables.background_normal.at(x, y), b = tables.background_normal.at(x, y);
      other_normals += std::abs(a.x - b.x) + std::abs(a.y - b.y) + std::abs(a.z - b.z) > 6;
    }
  std::sort(limit_error.begin(), limit_error.end());
  EXPECT_LT(limit_error[limit_error.size() * 95 / 100], 0.01F);
  EXPECT_LT(other_normals, static_cast<int>(limit_error.size() / 100));
}

TEST(Background, NormalsTurnWithTheCamera) {
  const Modelled m;
  const geometry::Pose turned{Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY())),
                              {0, 0, 0}};
  const DrawnBackground drawn(m, turned);
  // The back wall faces -z of the world.
  const Eigen::Vector3d expected = turned.rotation.inverse() * -Eigen::Vector3d::UnitZ();
  const auto n = drawn.tables.background_normal.at(100, 110);
  EXPECT_NEAR(n.x, 127 * expected.x(), 5);
  EXPECT_NEAR(n.y, 127 * expected.y(), 5);
  EXPECT_NEAR(n.z, 127 * expected.z(), 5);
}

TEST(Background, ThreadsDoNotChangeIt) {
  const Modelled m;
  const DrawnBackground one(m, moved({0.1, 0, 0}), 1), three(m, moved({0.1, 0, 0}), 3);
  for (int y = 0; y < kPannedView.height; ++y)
    for (int x = 0; x < kPannedView.width; ++x)
      ASSERT_EQ(one.background.view().depth_m.row(y)[x], three.background.view().depth_m.row(y)[x]);
}

/// Share of the pixels whose person the key finds, and of those that it takes for one by mistake.
struct Key {
  double found = 0, wrong = 0;
};
Key keyed(render::CompositorSetup setup, AnalyticScene scene, const Eigen::Vector3d& at_m) {
  scene.person = true;
  const Camera target = camera_at(at_m), tof{kPannedTof, kTof_f_px, at_m};
  Image<float> truth_m;
  Image<std::uint8_t> person;
  render_truth(scene, target, truth_m, person);
  auto compositor = render::make_cpu_compositor(setup, 2);
  EXPECT_TRUE(compositor);
  render::FrameOutput out;
  EXPECT_TRUE(
      (*compositor)
          ->compose({render_plate(scene, target, 3), render_tof(scene, tof, 4, 0.006), moved(at_m)},
                    out));
  double hit = 0, either = 0, wrong = 0;
  for (int y = 0; y < kPannedView.height; ++y)
    for (int x = 0; x < kPannedView.width; ++x) {
      const bool is = person.at(x, y) > 0, said = out.matte.at(x, y) >= 128;
      hit += is && said, either += is || said, wrong += said && !is;
    }
  return {hit / either, wrong / static_cast<double>(kPannedView.area())};
}

TEST(Background, AMovedCameraKeysAsWellAsAStillOne) {
  const Modelled m;
  render::CompositorSetup still = m.setup;
  still.background_models.clear();
  still.background = {m.depth_m, {}, m.color, m.color_sigma};
  const Key at_rest = keyed(still, m.scene, {0, 0, 0});
  const Eigen::Vector3d aside(0.15, 0.05, 0.1);
  const Key followed = keyed(m.setup, m.scene, aside);
  const Key frozen = keyed(still, m.scene, aside);
  EXPECT_GT(followed.found, at_rest.found - 0.03);
  EXPECT_LT(frozen.found, 0.8) << "the test can tell a followed background from a frozen one";
}

TEST(Background, DrawingAllocatesNothing) {
  const Modelled m;
  DrawnBackground drawn(m, {});
  const long before = allocations;
  drawn.background.draw(drawn.crew, moved({0.05, 0, 0}), drawn.tables);
  drawn.background.draw_color(100, 100, 100);
  EXPECT_EQ(allocations, before);
}

/// A lamp, and a post on the scene's floor: a triangle with an edge on the floor and one upwards.
struct LitPost {
  explicit LitPost(Modelled& m) {
    render::VirtualObject post;
    post.meshes.push_back({positions, normals, {}, triangle, glm::vec3(1), {}, true});
    post.world_from_object.translation_m = {0.4, m.scene.floor_y_m, 3};
    // The post's z axis is up; the world's y points down.
    post.world_from_object.rotation = Eigen::AngleAxisd(0.5 * M_PI, Eigen::Vector3d::UnitX());
    m.setup.objects = {post};
    m.setup.light.lamps = {{{0, -1.3, 3}, std::nullopt, {0.2, 0.2}, {1, 1, 1}}};
  }
  const std::vector<glm::vec3> positions{{0, 0, 0}, {0.1F, 0, 0}, {0, 0, 0.5F}};
  const std::vector<glm::vec3> normals{{0, 1, 0}, {0, 1, 0}, {0, 1, 0}};
  const std::vector<std::uint32_t> triangle{0, 1, 2};
};

/// Light on more than one way: the floor is learned 3 % too far.
TEST(Background, LightFallsOnAFloorThatGoesThroughTheFeetOfObjects) {
  Modelled m;
  for (int y = 0; y < kPannedView.height; ++y)
    for (int x = 0; x < kPannedView.width; ++x)
      m.depth_m.at(x, y) *= y > kPannedView.height / 2 ? 1.03F : 1.0F;
  const LitPost post(m);
  const Eigen::Vector3d at(0.1, -0.05, 0.1);
  const DrawnBackground drawn(m, moved(at));
  Image<float> truth_m;
  Image<std::uint8_t> person;
  render_truth(m.scene, camera_at(at), truth_m, person);
  for (const auto& [x, y] : {std::pair(150, 240), {200, 230}, {90, 250}, {180, 250}}) {
    const float truth = truth_m.at(x, y);
    EXPECT_NEAR(drawn.background.light_depth_m().row(y)[x] / truth, 1, 0.006) << x << ", " << y;
    EXPECT_NEAR(drawn.background.view().depth_m.row(y)[x] / truth, 1.03, 0.01) << "as learned";
  }
  // Pixels that lie on no plane that was found, or are unknown, stay as they were drawn.
  const auto pole_x = static_cast<int>(159.5 + kView_f_px * (m.scene.pole_x_m - at.x()) /
                                                   (m.scene.pole_z_m - at.z()));
  EXPECT_EQ(drawn.background.light_depth_m().row(128)[pole_x],
            drawn.background.view().depth_m.row(128)[pole_x]);
}

/// Depth seen in a mirror has wrapped around and hangs before the mirror's wall.
TEST(Background, AMirrorIsTheWallAroundItForMixAndLightAndNotForTheKey) {
  Modelled m;
  m.scene.pole = false;
  Image<std::uint8_t> person;
  render_truth(m.scene, camera_at({0, 0, 0}), m.depth_m, person);
  Image<float> sigma_m(kPannedView);
  constexpr int kLeft = 180, kTop = 90, kRight = 230, kBottom = 130;
  for (int y = 0; y < kPannedView.height; ++y)
    for (int x = 0; x < kPannedView.width; ++x) {
      const bool mirror = x >= kLeft && x < kRight && y >= kTop && y < kBottom;
      float& z = m.depth_m.at(x, y);
      if (mirror) z = 3;
      sigma_m.at(x, y) = 0.001F * z * z * (mirror ? 10 : 1);
    }
  m.setup.background_models[0].depth_sigma_m = sigma_m;
  const DrawnBackground before(m, {});
  const LitPost post(m);
  const DrawnBackground drawn(m, moved({0.02, 0, 0}));
  const int x = 205, y = 110;
  EXPECT_NEAR(before.background.view().depth_m.row(y)[x], 3, 0.02) << "nothing takes light";
  EXPECT_NEAR(drawn.background.view().depth_m.row(y)[x], m.scene.back_z_m, 0.03);
  EXPECT_NEAR(drawn.background.light_depth_m().row(y)[x], m.scene.back_z_m, 0.03);
  EXPECT_LT(1 / drawn.tables.key_limit_w.at(x, y), 3);
  EXPECT_NEAR(drawn.background.view().depth_m.row(y)[250], m.scene.back_z_m, 0.03);
}

TEST(Background, DrawingPlanesForLightAllocatesNothing) {
  Modelled m;
  const LitPost post(m);
  DrawnBackground drawn(m, {});
  const long before = allocations;
  drawn.background.draw(drawn.crew, moved({0.05, 0, 0}), drawn.tables);
  EXPECT_EQ(allocations, before);
}

TEST(Background, ASetupWithTwoBackgroundsIsRefused) {
  Modelled m;
  m.setup.background = {m.depth_m, {}, m.color, m.color_sigma};
  const auto compositor = render::make_cpu_compositor(m.setup, 1);
  ASSERT_FALSE(compositor);
  EXPECT_NE(compositor.error().context.find("two backgrounds"), std::string::npos);
}

}  // namespace
}  // namespace mixrig::test

// SPDX-License-Identifier: Apache-2.0
// The empty room learned by a camera that moves, against a scene that is ray-cast.
#include "host/room/background/learn.h"

#include <cmath>

#include <gtest/gtest.h>

#include "host/pose/source/fixed_poses.h"
#include "host/run/session/session.h"
#include "tests/support/analytic_scene.h"
#include "tests/support/box_source.h"
#include "tests/support/each_pixel.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::session {
namespace {

constexpr geometry::Pinhole kLearnView{{160, 120}, 130, 130, 79.5, 59.5};

geometry::Pose turned(double yaw_rad, double x_m = 0) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitY())), {x_m, 0, 0}};
}

std::vector<PosedView> posed(const std::vector<geometry::Pose>& poses) {
  std::vector<PosedView> views;
  for (const geometry::Pose& pose : poses) views.push_back({kLearnView, pose});
  return views;
}

TEST(ViewOfAll, OfOnePoseIsItsView) {
  const std::vector<geometry::Pose> poses = {turned(0.3, 1)};
  const auto wide = view_of_all(posed(poses));
  ASSERT_TRUE(wide) << wide.error().context;
  EXPECT_NEAR(wide->world_from_camera.rotation.angularDistance(poses[0].rotation), 0, 1e-9);
  EXPECT_NEAR((wide->world_from_camera.translation_m - poses[0].translation_m).norm(), 0, 1e-12);
  EXPECT_NEAR(wide->camera.size_px.width, kLearnView.size_px.width, 2);
  EXPECT_NEAR(wide->camera.size_px.height, kLearnView.size_px.height, 2);
  EXPECT_EQ(wide->camera.fx_px, kLearnView.fx_px);
}

TEST(ViewOfAll, HoldsTheCornersOfEveryView) {
  const std::vector<geometry::Pose> poses = {turned(-0.2, -0.1), turned(0, 0), turned(0.25, 0.1)};
  const auto wide = view_of_all(posed(poses));
  ASSERT_TRUE(wide) << wide.error().context;
  const Eigen::Isometry3d world_from_wide(wide->world_from_camera.matrix());
  for (const geometry::Pose& pose : poses)
    for (const double u : {0.0, 159.0})
      for (const double v : {0.0, 119.0})
        for (const double z_m : {1.6, 4.0, 50.0}) {
          const Eigen::Vector3d p((u - 79.5) / 130 * z_m, (v - 59.5) / 130 * z_m, z_m);
          const Eigen::Vector3d q =
              world_from_wide.inverse() * (Eigen::Isometry3d(pose.matrix()) * p);
          const double x = wide->camera.fx_px * q.x() / q.z() + wide->camera.cx_px;
          const double y = wide->camera.fy_px * q.y() / q.z() + wide->camera.cy_px;
          EXPECT_GE(x, -0.5);
          EXPECT_GE(y, -0.5);
          EXPECT_LE(x, wide->camera.size_px.width - 0.5);
          EXPECT_LE(y, wide->camera.size_px.height - 0.5);
        }
}

TEST(ViewOfAll, RefusesATurnThatNoPinholeHolds) {
  for (const double yaw_rad : {1.2, 1.6, 2.5}) {
    const std::vector<geometry::Pose> poses = {turned(-yaw_rad), turned(yaw_rad)};
    EXPECT_TRUE(test::refused(view_of_all(posed(poses)), {"turns too far"})) << yaw_rad;
  }
}

/// The analytic room without a person, seen by a camera that is carried to the right.
class CarriedSource final : public capture::CaptureSource {
 public:
  static constexpr int kFrames = 9;
  CarriedSource() {
    scene_.person = false;
    info_.name = "carried";
    info_.target.pinhole = kLearnView;
    info_.tof = info_.target;
    info_.noise = {0.004, 0, 0};
    info_.frames = kFrames;
    info_.moves = true;
  }
  static double x_m(int number) { return 0.08 * (number - 5); }
  const capture::SourceInfo& info() const override { return info_; }
  Result<bool> read(int number, capture::Capture& frame) override {
    const test::Camera camera{kLearnView.size_px, kLearnView.fx_px, {x_m(number), 0, 0}};
    frame.number = number;
    frame.plate = test::render_plate(scene_, camera, static_cast<std::uint32_t>(number));
    Image<std::uint8_t> person;
    test::render_truth(scene_, camera, frame.depth_m, person);
    if (mirror_) remove_mirror(x_m(number), frame.depth_m);
    frame.world_from_target = turned(0, x_m(number));
    frame.pose_origin = capture::PoseOrigin::kRecorded;
    return true;
  }
  Result<void> read_truth(int, capture::Truth&) override { return {}; }
  void make_endless() { info_.frames = capture::kEndless; }
  void hang_mirror() { mirror_ = true; }
  /// Whether a place of the back wall is the mirror, which returns no light.
  static bool is_mirror(const Eigen::Vector3d& at_m) {
    return std::abs(at_m.z() - test::AnalyticScene().back_z_m) < 1e-3 &&
           std::abs(at_m.x() - kMirrorX_m) < kMirrorHalf_m && std::abs(at_m.y()) < kMirrorHalf_m;
  }
  const test::AnalyticScene& scene() const { return scene_; }

 private:
  static constexpr double kMirrorX_m = 0.3, kMirrorHalf_m = 0.4;
  static void remove_mirror(double x_m, Image<float>& depth_m) {
    for (const auto [x, y] : test::each_pixel({0, 0}, {depth_m.width(), depth_m.height()})) {
      const Eigen::Vector2d ray = kLearnView.unproject({x, y});
      float& z_m = depth_m.at(x, y);
      if (is_mirror({x_m + z_m * ray.x(), z_m * ray.y(), z_m})) z_m = 0;
    }
  }
  test::AnalyticScene scene_;
  bool mirror_ = false;
  capture::SourceInfo info_;
};

Result<model::StaticBackground> learned_on_the_way(CarriedSource& source) {
  MIXRIG_ASSIGN(const auto setup, setup_of(source.info(), std::nullopt));
  const auto poses = pose::make_own_poses(true, true);
  return learn_background(source, setup, {1, CarriedSource::kFrames}, {render::Backend::kCpu, 2},
                          {}, poses.get());
}

TEST(LearnMoving, TheRoomIsWhereItIsAndWiderThanAFrame) {
  CarriedSource source;
  const auto learned = learned_on_the_way(source);
  ASSERT_TRUE(learned) << learned.error().context;
  ASSERT_TRUE(learned->world_from_view);
  EXPECT_GT(learned->view.size_px.width, kLearnView.size_px.width + 20);
  const Eigen::Isometry3d world_from_view(learned->world_from_view->matrix());
  int all = 0, known = 0, right = 0, colored = 0;
  for (const auto [x, y] : test::each_pixel(
           {10, 10}, {learned->view.size_px.width - 10, learned->view.size_px.height - 10})) {
    const Eigen::Vector2d ray = learned->view.unproject({x, y});
    const test::Hit hit =
        test::cast(source.scene(), world_from_view.translation(),
                   world_from_view.rotation() * Eigen::Vector3d(ray.x(), ray.y(), 1));
    ++all;
    const float z = learned->depth_m.at(x, y);
    colored += learned->color.at(x, y).r >= 0;
    if (!(z > 0)) continue;
    ++known;
    right += std::abs(z - hit.t) < 0.02 * hit.t;
  }
  EXPECT_GT(known, 0.8 * all) << "the outermost columns are seen by fewer than three frames";
  EXPECT_GT(right, 0.95 * known);
  EXPECT_EQ(colored, known) << "a colour is known where the depth is";
}

TEST(LearnMoving, AMirrorIsTheWallThatItHangsOn) {
  CarriedSource source;
  source.hang_mirror();
  const auto learned = learned_on_the_way(source);
  ASSERT_TRUE(learned) << learned.error().context;
  const Eigen::Isometry3d world_from_view(learned->world_from_view->matrix());
  int mirror = 0, on_wall = 0, colored = 0;
  for (const auto [x, y] :
       test::each_pixel({0, 0}, {learned->view.size_px.width, learned->view.size_px.height})) {
    const Eigen::Vector2d ray = learned->view.unproject({x, y});
    const Eigen::Vector3d from_m = world_from_view.translation();
    const Eigen::Vector3d direction =
        world_from_view.rotation() * Eigen::Vector3d(ray.x(), ray.y(), 1);
    const test::Hit hit = test::cast(source.scene(), from_m, direction);
    if (!CarriedSource::is_mirror(from_m + hit.t * direction)) continue;
    ++mirror;
    on_wall += std::abs(learned->depth_m.at(x, y) - hit.t) < 0.02 * hit.t;
    colored += learned->color.at(x, y).r >= 0;
  }
  EXPECT_GT(mirror, 400);
  EXPECT_GT(on_wall, 0.98 * mirror) << "people before it are keyed by depth";
  EXPECT_EQ(colored, mirror);
}

TEST(LearnMoving, WithoutPosesItIsAStillCamera) {
  CarriedSource source;
  const auto setup = setup_of(source.info(), std::nullopt);
  ASSERT_TRUE(setup);
  const auto learned =
      learn_background(source, *setup, {1, CarriedSource::kFrames}, {render::Backend::kCpu, 2}, {});
  ASSERT_TRUE(learned);
  EXPECT_EQ(learned->view, setup->view);
  EXPECT_FALSE(learned->world_from_view);
}

TEST(LearnMoving, ALiveCameraMustStandStill) {
  CarriedSource source;
  source.make_endless();
  const auto setup = setup_of(source.info(), std::nullopt);
  ASSERT_TRUE(setup);
  const auto poses = pose::make_own_poses(true, true);
  const auto learned =
      learn_background(source, *setup, {1, 5}, {render::Backend::kCpu, 1}, {}, poses.get());
  EXPECT_TRUE(test::refused(learned, {"keep it still"}));
}

/// The room, seen by a camera at rest whose lens zooms in and whose pupil moves.
class ZoomingSource final : public capture::CaptureSource {
 public:
  static constexpr int kFrames = 9;
  ZoomingSource() {
    scene_.person = false;
    info_.name = "zooming";
    info_.target.pinhole = kLearnView;
    info_.tof = info_.target;
    info_.noise = {0.004, 0, 0};
    info_.frames = kFrames;
    info_.lens = std::make_shared<geometry::LensTable>(
        *geometry::LensTable::make({{{0, 0}, lens(1), 0}, {{1, 0}, lens(2), 0}}));
  }
  const capture::SourceInfo& info() const override { return info_; }
  Result<bool> read(int number, capture::Capture& frame) override {
    const double zoom = 1 + 0.1 * (number - 1);
    const geometry::LensState state = lens(zoom);
    const test::Camera rest{kLearnView.size_px, kLearnView.fx_px, {0, 0, 0}};
    const test::Camera zoomed{
        kLearnView.size_px, state.camera.pinhole.fx_px, {0, 0, state.pupil_shift_m}};
    frame.number = number;
    frame.plate = test::render_plate(scene_, zoomed, static_cast<std::uint32_t>(number));
    Image<std::uint8_t> person;
    test::render_truth(scene_, rest, frame.depth_m, person);
    frame.lens = capture::FrameLens{state, capture::LensOrigin::kEncoded};
    return true;
  }
  Result<void> read_truth(int, capture::Truth&) override { return {}; }
  const test::AnalyticScene& scene() const { return scene_; }

 private:
  static geometry::LensState lens(double zoom) {
    geometry::CameraModel camera{kLearnView, {}};
    camera.pinhole.fx_px *= zoom, camera.pinhole.fy_px *= zoom;
    return {camera, 0.05 * (zoom - 1)};
  }
  test::AnalyticScene scene_;
  capture::SourceInfo info_;
};

TEST(LearnMoving, ARoomThroughALensThatZoomsIsWhereItIs) {
  ZoomingSource source;
  const auto setup = setup_of(source.info(), std::nullopt);
  ASSERT_TRUE(setup);
  ASSERT_TRUE(setup->lens_moves);
  const auto poses = pose::make_fixed_pose(turned(0.2, 1), "fixed", "fixed");
  const auto learned = learn_background(source, *setup, {1, ZoomingSource::kFrames},
                                        {render::Backend::kCpu, 2}, {}, poses.get());
  ASSERT_TRUE(learned) << learned.error().context;
  ASSERT_TRUE(learned->world_from_view);
  EXPECT_NEAR(learned->view.fx_px, 1.8 * kLearnView.fx_px, 1e-9);
  const geometry::Pose target_from_view =
      geometry::inverse(turned(0.2, 1)) * *learned->world_from_view;
  EXPECT_NEAR(target_from_view.translation_m.z(), 0.02, 1e-9) << "the mean of the pupils";
  int all = 0, known = 0, right = 0;
  for (const auto [x, y] : test::each_pixel(
           {10, 10}, {learned->view.size_px.width - 10, learned->view.size_px.height - 10})) {
    const Eigen::Vector2d ray = learned->view.unproject({x, y});
    const test::Hit hit = test::cast(source.scene(), target_from_view.translation_m,
                                     Eigen::Vector3d(ray.x(), ray.y(), 1));
    ++all;
    const float z = learned->depth_m.at(x, y);
    if (!(z > 0)) continue;
    ++known;
    right += std::abs(z - hit.t) < 0.02 * hit.t;
  }
  EXPECT_GT(known, 0.6 * all) << "a third of the frames see the middle 83 % of each side";
  EXPECT_GT(right, 0.95 * known);
}

TEST(LearnMoving, AScannedBackgroundOfAMovingCameraNeedsItsPose) {
  Session session;
  session.source = std::make_unique<test::BoxSource>(5, 6, true);
  const auto setup = setup_of(session.source->info(), std::nullopt);
  ASSERT_TRUE(setup);
  session.poses = pose::make_own_poses(false, true);
  const test::TemporaryFolder parent;
  const auto folder = parent / "background";
  model::StaticBackground background;
  background.view = setup->view;
  background.frames = 3;
  background.depth_m.reset(setup->view.size_px, 3);
  background.depth_sigma_m.reset(setup->view.size_px, 0.01F);
  background.color.reset(setup->view.size_px, {0.2F, 0.2F, 0.2F});
  background.color_sigma.reset(setup->view.size_px, 0.01F);
  session.setup = *setup;
  session.scene.background.model = folder;
  ASSERT_TRUE(model::save(background, folder));
  EXPECT_TRUE(test::refused(prepare_background(session, {}), {"from where it was learned"}));

  background.world_from_view = turned(0.1, 0.5);
  ASSERT_TRUE(model::save(background, folder));
  ASSERT_TRUE(prepare_background(session, {}));
  ASSERT_FALSE(session.setup.background_models.empty());
  EXPECT_NEAR(session.setup.background_models.front().world_from_face[0].translation_m.x(), 0.5,
              1e-12);
  EXPECT_TRUE(session.setup.background.depth_m.empty());
}

}  // namespace
}  // namespace mixrig::session

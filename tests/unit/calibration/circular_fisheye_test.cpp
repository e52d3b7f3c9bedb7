// SPDX-License-Identifier: Apache-2.0
// Calibration of a lens of 190 degrees whose image is a circle inside the picture, with boards held
// mostly near its rim.
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "host/calibration/intrinsics/intrinsics.h"
#include "host/calibration/intrinsics/uncertainty.h"

namespace mixrig::calibration {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;
using geometry::AnyCamera;
using geometry::LensKind;

constexpr double kDegree = M_PI / 180;
constexpr Size kSize{640, 480};
constexpr double kRim_rad = 95 * kDegree;
const BoardSpec kBoard = *parse_board("checkerboard:9x6:25mm");

/// Folds at 113 degrees: beyond the circle, and nearer to the axis than the sides of the picture.
AnyCamera true_lens() {
  Eigen::VectorXd v(8);
  v << 150, 150.4, 323.2, 238.1, -0.02, -0.0053, 0.001, -0.0006;
  return geometry::make_camera(LensKind::kFisheye, kSize, v, kRim_rad);
}

ImageCircle true_circle() {
  const auto lens = std::get<geometry::FisheyeModel>(true_lens());
  return {{lens.parameters().cx_px, lens.parameters().cy_px}, lens.rim_px().mean(), 0, 0};
}

/// Every fourth board before the camera, the others with their middle 50 to 75 degrees from the
/// axis.
std::vector<geometry::Pose> poses_near_the_rim(unsigned seed, int count) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<geometry::Pose> poses;
  for (int i = 0; i < count; ++i) {
    const double theta = i % 4 == 0 ? 0.3 : (62.5 + 12.5 * unit(random)) * kDegree;
    const double phi = 2.4 * i;
    const Vector3d ray(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                       std::cos(theta));
    const Quaterniond facing = Quaterniond::FromTwoVectors(Vector3d::UnitZ(), ray) *
                               Eigen::AngleAxisd(0.5 * unit(random), Vector3d::UnitX()) *
                               Eigen::AngleAxisd(0.5 * unit(random), Vector3d::UnitY()) *
                               Eigen::AngleAxisd(3 * unit(random), Vector3d::UnitZ());
    const double distance_m = 0.25 + 0.05 * unit(random);
    poses.push_back({facing, distance_m * ray - facing * Vector3d(0.1, 0.0625, 0)});
  }
  return poses;
}

std::vector<ObservedView> observe_fisheye(const std::vector<geometry::Pose>& poses, double sigma_px,
                                          unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, sigma_px);
  const auto points = board_points_m(kBoard);
  std::vector<ObservedView> views;
  for (const auto& pose : poses) {
    ObservedView view;
    view.name = "view " + std::to_string(views.size() + 1);
    view.board.blur_px = 0.7;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto px = geometry::project(true_lens(), pose * points[i]);
      if (!px) continue;
      view.board.ids.push_back(static_cast<int>(i));
      view.board.px.emplace_back(px->x() + noise(random), px->y() + noise(random));
    }
    views.push_back(view);
  }
  return views;
}

IntrinsicsOptions circular() {
  IntrinsicsOptions options;
  options.kind = LensKind::kFisheye;
  options.circle = true_circle();
  return options;
}

/// (estimate - truth)^T covariance^-1 (estimate - truth) over the number of parameters.
double nees_of(const Intrinsics& found) {
  const auto& free = found.bundle.free;
  const auto count = static_cast<Eigen::Index>(free.size());
  const Eigen::VectorXd off =
      geometry::parameters_of(found.camera) - geometry::parameters_of(true_lens());
  Eigen::VectorXd error(count);
  Eigen::MatrixXd covariance(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    error[i] = off[free[static_cast<std::size_t>(i)]];
    for (Eigen::Index j = 0; j < count; ++j)
      covariance(i, j) =
          found.covariance(free[static_cast<std::size_t>(i)], free[static_cast<std::size_t>(j)]);
  }
  return error.dot(covariance.ldlt().solve(error)) / static_cast<double>(count);
}

/// Root mean square angle between the rays of pixels at an angle from the true axis, once a common
/// rotation (which no board tells from another pose) is taken out.
double ray_error_deg(const AnyCamera& found, double theta) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  const auto rays = [&](double angle, auto&& use) {
    for (double phi = 0; phi < 6.2; phi += 0.3) {
      const Vector3d truth(std::sin(angle) * std::cos(phi), std::sin(angle) * std::sin(phi),
                           std::cos(angle));
      if (const auto ray = geometry::unproject(found, *geometry::project(true_lens(), truth)))
        use(truth, *ray);
    }
  };
  for (double angle = 0.1; angle < 1.5; angle += 0.1)
    rays(angle, [&](const Vector3d& a, const Vector3d& b) { sum += a * b.transpose(); });
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d turn = svd.matrixU() * svd.matrixV().transpose();
  double squares = 0;
  int count = 0;
  rays(theta, [&](const Vector3d& a, const Vector3d& b) {
    squares += (a - turn * b).squaredNorm();
    ++count;
  });
  return std::sqrt(squares / count) / kDegree;
}

TEST(CircularFisheye, TheTrueLensFoldsInsideThePictureAndNotInsideItsCircle) {
  EXPECT_TRUE(geometry::validate(true_lens()));
  const auto whole =
      geometry::make_camera(LensKind::kFisheye, kSize, geometry::parameters_of(true_lens()));
  EXPECT_FALSE(geometry::validate(whole));
}

TEST(CircularFisheye, IsFoundWithinItsSigmasFromBoardsNearTheRim) {
  double nees = 0, rim = 0, rim_error = 0;
  constexpr int kRuns = 6;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    const auto views = observe_fisheye(poses_near_the_rim(seed, 14), 0.1, seed);
    IntrinsicsOptions options = circular();
    if (seed > 1) options.lens_terms = 4;  // the choice is made once
    const auto found = solve_intrinsics(kBoard, kSize, views, options);
    ASSERT_TRUE(found) << seed << ": " << found.error().context;
    EXPECT_EQ(found->lens_terms, 4);
    EXPECT_TRUE(geometry::validate(found->camera));
    EXPECT_NEAR(found->sigma_px, 0.1, 0.01);
    EXPECT_NEAR(found->held_out_px, 0.1 * std::sqrt(2.0), 0.02);
    EXPECT_GT(found->point_angle_rad, 80 * kDegree);
    const auto largest = geometry::max_angle_rad(found->camera);
    ASSERT_TRUE(largest);
    // The smallest angle on the rim, where fx and fy differ.
    EXPECT_NEAR(*largest / kDegree, 94.8, 0.3);
    const UncertaintyMap map = projection_uncertainty(*found, 12, 9);
    EXPECT_GE(map.worst_px, map.rim_px);
    EXPECT_TRUE(std::isnan(map.sigma_px.front())) << "a corner of the picture is no image";
    const double error_px = ray_error_deg(found->camera, 94.5 * kDegree) * kDegree * 100;
    nees += nees_of(*found) / kRuns;
    rim += map.rim_px * map.rim_px / kRuns;
    rim_error += error_px * error_px / kRuns;
    std::printf(
        "seed %u: %d terms, points to %.1f deg, largest %.2f deg, rim %.3f px, worst %.3f px; ray "
        "error "
        "deg at 30, 60, 80, 90, 94.5: %.4f %.4f %.4f %.4f %.4f\n",
        seed, found->lens_terms, found->point_angle_rad / kDegree, *largest / kDegree, map.rim_px,
        map.worst_px, ray_error_deg(found->camera, 30 * kDegree),
        ray_error_deg(found->camera, 60 * kDegree), ray_error_deg(found->camera, 80 * kDegree),
        ray_error_deg(found->camera, 90 * kDegree), ray_error_deg(found->camera, 94.5 * kDegree));
  }
  std::printf("NEES %.3f; rim: stated %.3f px, error about %.3f px\n", nees, std::sqrt(rim),
              std::sqrt(rim_error));
  // Chi-squared of 6 runs of 8 parameters: 95 % lie within 0.64 .. 1.44.
  EXPECT_GT(nees, 0.5);
  EXPECT_LT(nees, 1.6);
}

TEST(CircularFisheye, PointsBeyondTheCircleDoNotCount) {
  const auto poses = poses_near_the_rim(3, 12);
  auto views = observe_fisheye(poses, 0.1, 3);
  for (std::size_t v = 0; v < 5; ++v) {
    BoardView& board = views[v].board;
    board.ids.pop_back();
    board.px.pop_back();
  }
  const auto clean = solve_intrinsics(kBoard, kSize, views, circular());
  ASSERT_TRUE(clean) << clean.error().context;
  // A finder that takes reflections on the lens's mount for corners.
  for (std::size_t v = 0; v < 5; ++v) {
    BoardView& board = views[v].board;
    board.ids.push_back(board.ids.back() + 1);
    board.px.emplace_back(true_circle().center_px + Vector2d(0, 1.01 * true_circle().radius_px));
  }
  const auto found = solve_intrinsics(kBoard, kSize, views, circular());
  ASSERT_TRUE(found) << found.error().context;
  EXPECT_EQ(geometry::parameters_of(found->camera), geometry::parameters_of(clean->camera));
  EXPECT_EQ(found->points_beyond, clean->points_beyond + 5);
}

TEST(CircularFisheye, ALensThatFoldsInsideTheCircleIsRefused) {
  const auto views = observe_fisheye(poses_near_the_rim(2, 12), 0.1, 2);
  IntrinsicsOptions options = circular();
  options.circle->radius_px = 290;  // no light comes that far: the lens folds before
  const auto found = solve_intrinsics(kBoard, kSize, views, options);
  ASSERT_FALSE(found);
  EXPECT_NE(found.error().context.find("folds inside its image circle of radius 290.0 px"),
            std::string::npos)
      << found.error().context;
  EXPECT_NE(found.error().context.find(" degrees from its axis"), std::string::npos);
}

TEST(CircularFisheye, WithoutACircleTheLensEndsNearTheOutermostPoint) {
  const auto views = observe_fisheye(poses_near_the_rim(4, 14), 0.1, 4);
  IntrinsicsOptions options = circular();
  options.circle.reset();
  const auto found = solve_intrinsics(kBoard, kSize, views, options);
  ASSERT_TRUE(found) << found.error().context;
  EXPECT_TRUE(found->ends_at_points);
  EXPECT_TRUE(geometry::validate(found->camera));
  EXPECT_NEAR(*geometry::max_angle_rad(found->camera), found->point_angle_rad + 0.05, 1e-9);
  EXPECT_LT(nees_of(*found), 3);
}

}  // namespace
}  // namespace mixrig::calibration

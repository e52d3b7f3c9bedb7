// SPDX-License-Identifier: Apache-2.0
// Calibration of a lens of 190 degrees whose image is a circle inside the picture, with boards held
// mostly near its rim.
#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <gtest/gtest.h>

#include "host/calibrate/intrinsics/intrinsics.h"
#include "host/calibrate/intrinsics/uncertainty.h"

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

constexpr std::array kAngles_deg{30, 60, 80, 90, 94};
using AngleErrors = Eigen::Array<double, kAngles_deg.size(), 1>;

/// Pairs of rays of the two lenses to the pixels at an angle from the axis of `truth`.
template <typename Use>
void pair_rays(const AnyCamera& truth, const AnyCamera& other, double angle, Use use) {
  for (double phi = 0; phi < 6.2; phi += 0.6) {
    const Vector3d ray(std::sin(angle) * std::cos(phi), std::sin(angle) * std::sin(phi),
                       std::cos(angle));
    const auto px = geometry::project(truth, ray);
    if (const auto seen = px ? geometry::unproject(other, *px) : std::nullopt) use(ray, *seen);
  }
}

/// Mean squares of the angles between the rays of two cameras, in degrees, after a common rotation
/// is removed (boards cannot distinguish it from another pose).
AngleErrors ray_errors_deg2(const AnyCamera& truth, const AnyCamera& other) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (double angle = 0.1; angle < 1.6; angle += 0.1)
    pair_rays(truth, other, angle,
              [&](const Vector3d& a, const Vector3d& b) { sum += a * b.transpose(); });
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d turn = svd.matrixU() * svd.matrixV().transpose();
  AngleErrors errors = AngleErrors::Zero();
  for (std::size_t i = 0; i < kAngles_deg.size(); ++i) {
    int count = 0;
    pair_rays(truth, other, kAngles_deg[i] * kDegree, [&](const Vector3d& a, const Vector3d& b) {
      errors[static_cast<Eigen::Index>(i)] += (a - turn * b).squaredNorm() / (kDegree * kDegree);
      ++count;
    });
    errors[static_cast<Eigen::Index>(i)] /= count;
  }
  return errors;
}

/// Mean squares of the angles for lenses drawn from the stated covariance.
AngleErrors stated_errors_deg2(const Intrinsics& found) {
  constexpr int kDraws = 10;
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(found.covariance);
  AngleErrors sum = AngleErrors::Zero();
  for (int draw = 0; draw < kDraws; ++draw) {
    Eigen::VectorXd z(axes.eigenvalues().size());
    for (Eigen::Index i = 0; i < z.size(); ++i)
      z[i] = normal(random) * std::sqrt(std::max(axes.eigenvalues()[i], 0.0));
    const Eigen::VectorXd v = found.bundle.intrinsics + axes.eigenvectors() * z;
    sum += ray_errors_deg2(found.camera, geometry::make_camera(LensKind::kFisheye, kSize, v));
  }
  return sum / kDraws;
}

TEST(CircularFisheye, TheTrueLensFoldsInsideThePictureAndNotInsideItsCircle) {
  EXPECT_TRUE(geometry::validate(true_lens()));
  const auto whole =
      geometry::make_camera(LensKind::kFisheye, kSize, geometry::parameters_of(true_lens()));
  EXPECT_FALSE(geometry::validate(whole));
}

TEST(CircularFisheye, IsFoundWithinItsSigmasFromBoardsNearTheRim) {
  double nees = 0;
  AngleErrors errors = AngleErrors::Zero(), stated = AngleErrors::Zero();
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
    // The smallest angle on the rim, where fx and fy differ.
    EXPECT_NEAR(geometry::max_angle_rad(found->camera).value_or(0) / kDegree, 94.8, 0.3);
    nees += nees_of(*found) / kRuns;
    errors += ray_errors_deg2(true_lens(), found->camera) / kRuns;
    stated += stated_errors_deg2(*found) / kRuns;
  }
  std::printf("NEES %.3f; angle: error and what the covariance states, degrees:\n", nees);
  for (std::size_t i = 0; i < kAngles_deg.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    std::printf("  %d: %.4f %.4f\n", kAngles_deg[i], std::sqrt(errors[at]), std::sqrt(stated[at]));
    EXPECT_LT(errors[at], 3 * stated[at]) << kAngles_deg[i];
    EXPECT_GT(errors[at], stated[at] / 5) << kAngles_deg[i];
  }
  // Chi-squared of 6 runs of 8 parameters: 95 % lie within 0.64 .. 1.44.
  EXPECT_GT(nees, 0.64);
  EXPECT_LT(nees, 1.44);
}

TEST(CircularFisheye, UncertaintyIsStatedOutToTheLargestAngleOnly) {
  const auto views = observe_fisheye(poses_near_the_rim(1, 14), 0.1, 1);
  IntrinsicsOptions options = circular();
  options.lens_terms = 4;
  const auto found = solve_intrinsics(kBoard, kSize, views, options);
  ASSERT_TRUE(found) << found.error().context;
  const UncertaintyMap map = projection_uncertainty(*found, 16, 12);
  for (int i = 0; i < 16 * 12; ++i) {
    const Vector2d px((i % 16 + 0.5) * 40 - 0.5, (i / 16 + 0.5) * 40 - 0.5);
    EXPECT_EQ(std::isnan(map.sigma_px[static_cast<std::size_t>(i)]),
              !geometry::unproject(found->camera, px).has_value());
    if (!true_circle().contains(px)) {
      EXPECT_TRUE(std::isnan(map.sigma_px[static_cast<std::size_t>(i)])) << px.transpose();
    }
  }
  EXPECT_GT(map.rim_px, 0.05);
  EXPECT_GE(map.worst_px, map.rim_px);
  EXPECT_LT(map.worst_px, 0.3);
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

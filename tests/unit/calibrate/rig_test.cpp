// SPDX-License-Identifier: Apache-2.0
// Parts of the joint calibration against independent truth: the studio's pattern, OpenCV's
// dictionary, sums by brute force.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "host/calibrate/rig/depth_fit.h"
#include "host/calibrate/rig/depth_terms.h"
#include "host/calibrate/rig/rig_start.h"
#include "host/math/estimation/verdict.h"
#include "studio/board/board_pattern.h"

namespace mixrig::calibration {
namespace {

ViewSet set_of(bool charuco) {
  ViewSet set;
  set.columns = 10, set.rows = 7;
  set.square_m = 0.07;
  set.board_kind = charuco ? "charuco" : "checkerboard";
  set.marker_m = 0.0525;
  set.dictionary = "4X4_50";
  return set;
}

/// Mean ink of the studio's print under a Gaussian, by a sum over a fine lattice.
double summed_ink(const studio::BoardPattern& pattern, const Eigen::Vector2d& uv,
                  const Eigen::Matrix2d& covariance, double square_m) {
  const Eigen::Matrix2d inverse = covariance.inverse();
  constexpr int kSteps = 160;
  const double reach = 5 * std::sqrt(covariance.diagonal().maxCoeff());
  double ink = 0, sum = 0;
  for (int j = -kSteps; j <= kSteps; ++j)
    for (int i = -kSteps; i <= kSteps; ++i) {
      const Eigen::Vector2d d(reach * (i + 0.37) / kSteps, reach * (j + 0.37) / kSteps);
      const double weight = std::exp(-0.5 * d.dot(inverse * d));
      const Eigen::Vector2f at = (square_m * (uv + d)).cast<float>();
      ink += weight * (pattern.white(at.x(), at.y()) ? 0 : 1), sum += weight;
    }
  return ink / sum;
}

TEST(BoardTexture, is_the_mean_of_the_studios_print) {
  Eigen::Matrix2d covariance;
  covariance << 0.0016, 0.0004, 0.0004, 0.0025;
  for (const bool charuco : {false, true}) {
    const ViewSet set = set_of(charuco);
    studio::BoardPlan plan;
    plan.kind = charuco ? studio::BoardKind::kCharuco : studio::BoardKind::kCheckerboard;
    const studio::BoardPattern pattern(plan);
    const auto print = print_of(set);
    ASSERT_TRUE(print);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> u(0.2, 9.8), v(0.2, 6.8);
    for (int i = 0; i < 60; ++i) {
      const Eigen::Vector2d uv(u(random), v(random));
      const double truth = summed_ink(pattern, uv, covariance, set.square_m);
      EXPECT_NEAR(ink_under(*print, uv, covariance).ink, truth, 0.012)
          << (charuco ? "charuco " : "checkerboard ") << uv.transpose();
      double plain = 0;
      if (is_plain(*print, uv, {0.2, 0.25}, plain)) {
        EXPECT_NEAR(plain, truth, 1e-3);
      }
    }
  }
}

TEST(BoardTexture, markers_of_the_studio_are_those_of_the_dictionary) {
  const auto print = print_of(set_of(true));
  ASSERT_TRUE(print);
  const auto bits = studio::marker_bits();
  for (std::size_t m = 0; m < 35; ++m)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i)
        EXPECT_EQ(print->ink[m * 36 + static_cast<std::size_t>((j + 1) * 6 + i + 1)] == 0,
                  (bits[m] >> (15 - 4 * j - i) & 1) != 0);
}

TEST(BoardTexture, derivatives_are_those_of_its_value) {
  Eigen::Matrix2d covariance;
  covariance << 0.0036, -0.0008, -0.0008, 0.0025;
  for (const bool charuco : {false, true}) {
    const auto print = print_of(set_of(charuco));
    for (const Eigen::Vector2d& uv :
         {Eigen::Vector2d(3.02, 2.6), {4.51, 3.97}, {5.03, 2.02}, {1.3, 4.4}}) {
      const InkShare at = ink_under(*print, uv, covariance);
      constexpr double kStep = 1e-6;
      for (int k = 0; k < 2; ++k) {
        const Eigen::Vector2d d = kStep * Eigen::Vector2d::Unit(k);
        const double slope = (ink_under(*print, uv + d, covariance).ink -
                              ink_under(*print, uv - d, covariance).ink) /
                             (2 * kStep);
        EXPECT_NEAR(at.d_uv[k], slope, 1e-5);
      }
    }
  }
}

TEST(BoardTexture, with_a_white_first_square_is_the_other_print_shifted_by_a_square) {
  const Eigen::Matrix2d covariance = 0.002 * Eigen::Matrix2d::Identity();
  for (const bool charuco : {false, true}) {
    ViewSet set = set_of(charuco);
    set.columns = 9, set.rows = 6;  // an odd number of columns: the same markers, one square apart
    const auto black_first = print_of(set);
    ASSERT_TRUE(black_first);
    BoardPrint white_first = *black_first;
    white_first.first_is_white = true;
    for (double u = 0.3; u < 7.5; u += 0.37)
      for (double v = 0.3; v < 5.8; v += 0.41) {
        const Eigen::Vector2d uv(u, v), next(u + 1, v);
        const InkShare at = ink_under(white_first, uv, covariance);
        const InkShare there = ink_under(*black_first, next, covariance);
        EXPECT_NEAR(at.ink, there.ink, 1e-9) << uv.transpose();
        EXPECT_LT((at.d_uv - there.d_uv).norm(), 1e-9) << uv.transpose();
        double ink = 0, ink_there = 0;
        EXPECT_EQ(is_plain(white_first, uv, {0.1, 0.1}, ink),
                  is_plain(*black_first, next, {0.1, 0.1}, ink_there));
        EXPECT_EQ(ink, ink_there) << uv.transpose();
      }
  }
}

TEST(DepthTerms, a_depth_along_the_axis_becomes_one_along_the_ray) {
  const auto print = print_of(set_of(false));
  ASSERT_TRUE(print);
  RigModel model;
  model.square_m = 0.07;
  model.cameras.resize(1);
  model.cameras[0].camera_from_target = {
      Eigen::Quaterniond(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitY())), {0.05, 0, 0}};
  model.target_from_board = {{Eigen::Quaterniond::Identity(), {0.2, -0.3, 1.1}}};
  const Scene scene = make_scene(model, *print, 0, 0);
  const Eigen::Vector3d point(0.4, 0.1, 0);
  const Eigen::Vector3d in_camera =
      model.cameras[0].camera_from_target * (model.target_from_board[0] * point);
  ViewPictures seen;
  seen.depth_is_z = true;
  EXPECT_NEAR(along_ray(scene, seen, in_camera.z(), point), in_camera.norm(), 1e-12);
  EXPECT_GT(in_camera.norm(), 1.1 * in_camera.z());
  seen.depth_is_z = false;
  EXPECT_EQ(along_ray(scene, seen, 1.5, point), 1.5);
}

TEST(SplineBasis, sums_to_one_and_meets_its_knots) {
  const std::vector<double> knots{0.5, 0.7, 1.1, 1.2, 2.0};
  Eigen::VectorXd values;
  for (std::size_t k = 0; k < knots.size(); ++k) {
    spline_basis(knots, knots[k], values);
    EXPECT_NEAR(values[static_cast<Eigen::Index>(k)], 1, 1e-12);
    EXPECT_NEAR(values.cwiseAbs().sum(), 1, 1e-12);
  }
  calibration_file::DepthError error;
  error.knots_m = knots, error.error_m = {0.01, -0.02, 0.005, 0.0, 0.03};
  for (double at = 0.3; at < 2.3; at += 0.037) {
    spline_basis(knots, at, values);
    EXPECT_NEAR(values.sum(), 1, 1e-9);
    EXPECT_NEAR(values.dot(Eigen::Map<const Eigen::VectorXd>(error.error_m.data(), 5)),
                error.at(at, 0, {0, 0}, {1, 1}), 1e-9)
        << at;
  }
}

/// Samples of a camera whose error is known.
std::vector<DepthSample> samples_of(double amplitude_m, double corner_m) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, 0.001);
  std::uniform_real_distribution<double> place(-1, 1), tilt(-0.15, 0.15);
  std::vector<DepthSample> samples;
  for (int view = 0; view < 16; ++view)
    for (int i = 0; i < 200; ++i) {
      DepthSample s;
      s.view = view;
      s.board_m = 0.9 + 0.09 * view + tilt(random);
      s.amplitude = (i % 2 == 0 ? 3000.0 : 400.0) / (s.board_m * s.board_m);
      s.place = {place(random), place(random)};
      s.weight = 20;
      s.measured_m = s.board_m + 0.012 * std::sin(4 * s.board_m) + amplitude_m / s.amplitude +
                     corner_m * s.place.squaredNorm() + noise(random);
      samples.push_back(s);
    }
  return samples;
}

TEST(DepthFit, takes_the_terms_that_are_there_and_no_others) {
  for (const bool amplitude : {false, true})
    for (const bool place : {false, true}) {
      const auto fit = fit_depth_error(samples_of(amplitude ? 2.0 : 0, place ? 0.006 : 0));
      ASSERT_TRUE(fit);
      EXPECT_EQ(fit->chosen.amplitude, amplitude);
      EXPECT_EQ(fit->chosen.place, place);
      EXPECT_LT(fit->chosen.held_out_m, 0.0013);
      if (amplitude) {
        EXPECT_NEAR(fit->error.amplitude_m, 2.0, 0.2);
      }
    }
}

TEST(DepthFit, tells_a_stretch_from_a_swing_and_an_offset) {
  const auto swing = fit_depth_error(samples_of(0, 0));
  ASSERT_TRUE(swing);
  EXPECT_LT(std::abs(swing->stretch), 0.01);
  auto samples = samples_of(0, 0);
  for (DepthSample& s : samples) s.measured_m += 0.04;
  const auto offset = fit_depth_error(samples);
  ASSERT_TRUE(offset);
  EXPECT_LT(std::abs(offset->stretch), 0.03);  // what is refused
  samples = samples_of(0, 0);
  for (DepthSample& s : samples) s.board_m *= 1.05;
  const auto stretched = fit_depth_error(samples);
  ASSERT_TRUE(stretched);
  EXPECT_LT(stretched->stretch, -0.03);
}

TEST(DepthFit, refuses_one_distance_and_too_few_views) {
  auto samples = samples_of(0, 0);
  std::vector<DepthSample> few;
  for (const DepthSample& s : samples)
    if (s.view < 3) few.push_back(s);
  EXPECT_FALSE(fit_depth_error(few));
  for (DepthSample& s : samples) s.measured_m = s.board_m = 1;
  const auto flat = fit_depth_error(samples);
  ASSERT_FALSE(flat);
  EXPECT_NE(flat.error().context.find("one distance"), std::string::npos);
}

TEST(Angles, are_read_whole_or_refused_with_the_line) {
  const auto good = parse_angles("view,pan_deg,tilt_deg\n1,10,-5\n2,0.0514,0\n", "ptu.csv", 2);
  ASSERT_TRUE(good);
  EXPECT_NEAR((*good)[0].pan_rad, 10 * M_PI / 180, 1e-12);
  const std::string head = "view,pan_deg,tilt_deg\n";
  for (const std::string& text :
       {head + "1,10\n2,0,0\n", head + "2,1,1\n", head + "1,nan,0\n2,0,0\n", head + "1,0,0\n",
        std::string(), head + "1,1e9,0\n2,0,0\n"})
    EXPECT_FALSE(parse_angles(text, "ptu.csv", 2)) << text;
}

TEST(Angles, in_radians_or_without_a_unit_are_refused_by_their_header) {
  const std::string rows = "1,0.17,-0.08\n2,0.01,0\n";
  for (const char* head : {"view,pan_deg,tilt_deg\n", "view,Pan [deg],Tilt [deg]\n"})
    EXPECT_TRUE(parse_angles(head + rows, "ptu.csv", 2)) << head;
  for (const char* head : {"view,pan_rad,tilt_rad\n", "view,pan,tilt\n", "view,pan_deg,tilt\n"}) {
    const auto angles = parse_angles(head + rows, "ptu.csv", 2);
    ASSERT_FALSE(angles) << head;
    EXPECT_NE(angles.error().context.find("ptu.csv:1: the header names"), std::string::npos);
  }
}

}  // namespace
}  // namespace mixrig::calibration

// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/pose/mocap/external.h"
#include "tests/support/random_geometry.h"

namespace mixrig::mocap {
namespace {

using Eigen::Vector3d;
using estimation::Standing;
using geometry::Pose;

std::string line_of(const char* key, const Vector3d& p) {
  return fmt::format("{} = [{:.9f}, {:.9f}, {:.9f}]\n", key, p.x(), p.y(), p.z());
}

/// Cortes Reina 2015, table 4, in metres: the constellation, its distances, and the camera's own
/// markers. The body's origin is put in the middle of its markers, its axes are those of the world.
std::string table4() {
  const Vector3d calibration[] = {{-0.5621, 0.8845, 0.1361},  {-0.2766, 0.8795, -0.1999},
                                  {-0.1235, 0.8763, -0.1048}, {-0.4262, 0.8293, -0.5435},
                                  {-0.7955, 0.9407, -0.4388}, {-0.7856, 0.8576, -0.3155}};
  const double distance_m[] = {1.2854, 1.0100, 0.8657, 1.1902, 1.4735, 1.4833};
  const Vector3d body[] = {{0.6661, 1.4412, -0.1311},
                           {0.6457, 1.3894, -0.0249},
                           {0.6467, 1.2437, -0.3556},
                           {0.5498, 1.2289, -0.1916}};
  const Vector3d middle = (body[0] + body[1] + body[2] + body[3]) / 4;
  std::string text = "[noise]\nmarker_m = 0.0005\n";
  for (int i = 0; i < 6; ++i)
    text += "[[marker]]\n" + line_of("world_m", calibration[i]) +
            "distance_m = " + std::to_string(distance_m[i]) + "\n";
  for (const Vector3d& p : body) text += "[[body_marker]]\n" + line_of("position_m", p - middle);
  for (int i : {2, 0, 3, 1}) text += "[[body_seen]]\n" + line_of("world_m", body[i]);
  return text;
}

TEST(CalibrateExternal, RedoesThePapersTable) {
  const auto input = parse_external(table4(), "table4.toml");
  ASSERT_TRUE(input) << input.error().context;
  const auto result = calibrate_external(*input);
  ASSERT_TRUE(result) << result.error().context;
  EXPECT_FALSE(result->body_from_camera.usable()) << "distances say nothing about orientation";
  EXPECT_NEAR(result->range_rms_m, 0.0095, 5e-5);
  EXPECT_EQ(result->camera_in_body_m.verdict.standing, Standing::kWeak);
  EXPECT_GT(std::abs(result->camera_in_body_m.verdict.direction.y()), 0.85);
  const Vector3d middle(0.627075, 1.3258, -0.1758);
  EXPECT_LT((result->camera_in_body_m.value + middle - Vector3d(0.6010, 1.3467, -0.1958)).norm(),
            2e-4);
  // The body's own markers (0.5 mm each over a hand's breadth) add to the weak height's 58 mm.
  EXPECT_NEAR(result->camera_in_body_m.verdict.sigma, 0.058, 0.002);
}

struct Setup {
  double noise = 1;
  std::uint64_t seed = 1;
};

constexpr double kRange_m = 0.004, kPixel_px = 0.2, kMarker_m = 0.0003;
const Pose kBody{estimation::rotation_exp({0.2, -0.7, 0.4}), {1.2, 1.5, -0.3}};
const Pose kCamera{estimation::rotation_exp({-0.1, 0.15, 1.4}), {0.06, -0.04, 0.11}};

/// A camera on a body before six markers: pixels and depths.
std::string whole(const Setup& setup) {
  test::RandomGeometry random(setup.seed);
  const geometry::CameraModel camera{{{512, 424}, 365, 365, 255, 211}, {}};
  const Pose world_from_camera = kBody * kCamera;
  std::string text =
      "[camera]\nsize_px = [512, 424]\nfocal_px = [365, 365]\ncentre_px = [255, 211]\n"
      "[noise]\nrange_m = 0.004\npixel_px = 0.2\nmarker_m = 0.0003\n";
  for (int i = 0; i < 6; ++i) {
    const Vector3d seen(random.uniform(-0.6, 0.6), random.uniform(-0.5, 0.5),
                        random.uniform(1.1, 1.9));
    const double along = (seen.norm() + setup.noise * kRange_m * random.normal()) / seen.norm();
    const Eigen::Vector2d px = camera.pinhole.project(seen);
    const double u = px.x() + setup.noise * kPixel_px * random.normal();
    const double v = px.y() + setup.noise * kPixel_px * random.normal();
    text += "[[marker]]\n" + line_of("world_m", world_from_camera * seen);
    text += "pixel_px = [" + std::to_string(u) + ", " + std::to_string(v) +
            "]\ndepth_m = " + std::to_string(along * seen.z()) + "\n";
  }
  for (const Vector3d& p : {Vector3d(0.02, 0.1, 0), Vector3d(-0.08, 0.03, 0.02),
                            Vector3d(0.05, -0.11, 0.01), Vector3d(0.01, 0.02, 0.09)}) {
    text += "[[body_marker]]\n" + line_of("position_m", p);
    const Vector3d noise = random.normal3(setup.noise * kMarker_m);
    text += "[[body_seen]]\n" + line_of("world_m", kBody * p + noise);
  }
  return text;
}

TEST(CalibrateExternal, FindsTheWholePoseFromPixelsAndDepths) {
  const auto result = calibrate_external(*parse_external(whole({0, 1}), "w.toml"));
  ASSERT_TRUE(result) << result.error().context;
  ASSERT_TRUE(result->body_from_camera.usable()) << result->body_from_camera.verdict.reason;
  const auto error = estimation::pose_error(result->body_from_camera.value, kCamera);
  EXPECT_LT(error.norm(), 1e-5) << "what the file's digits leave";
}

TEST(CalibrateExternal, ClaimsTheSigmaThatItHas) {
  double nees = 0;
  constexpr int kTrials = 1000;
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto result = calibrate_external(
        *parse_external(whole({1, 10u + static_cast<std::uint64_t>(trial)}), "w.toml"));
    ASSERT_TRUE(result) << result.error().context;
    const auto& pose = result->body_from_camera;
    const auto error = estimation::pose_error(pose.value, kCamera);
    nees += error.dot(pose.covariance.inverse() * error) / 6;
  }
  // 6000 degrees of freedom: 0.94..1.06 holds 99.9 %.
  EXPECT_NEAR(nees / kTrials, 1, 0.06);
}

TEST(ExternalFile, NamesWhatIsWrong) {
  const auto error_of = [](const std::string& text) {
    const auto input = parse_external(text, "x.toml");
    if (!input) return input.error().context;
    const auto result = calibrate_external(*input);
    return result ? std::string() : result.error().context;
  };
  const std::string good = table4();
  EXPECT_EQ(error_of(good), "");
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const auto at = text.find(from);
    return at == std::string::npos ? std::string("no such text")
                                   : text.replace(at, from.size(), to);
  };
  EXPECT_NE(error_of(with("distance_m = 1.285400", "distance_m = -1")).find("x.toml:5"),
            std::string::npos)
      << error_of(with("distance_m = 1.285400", "distance_m = -1"));
  EXPECT_NE(error_of(with("distance_m = 1.285400", "depth_m = 1.2")).find("depth_m"),
            std::string::npos);
  EXPECT_NE(error_of(with("distance_m = 1.285400", "distance = 1.2")).find("distance"),
            std::string::npos);
  EXPECT_NE(error_of("").find("[[marker]]"), std::string::npos);
  // Something else was seen than the body.
  std::string other = good.substr(0, good.find("[[body_seen]]"));
  for (int i = 0; i < 4; ++i)
    other += "[[body_seen]]\n" + line_of("world_m", Vector3d(i, i * i, 0));
  EXPECT_NE(error_of(other).find("body is not found"), std::string::npos) << error_of(other);
  // Distances that belong to other markers, at a stated noise.
  std::string mixed = with("marker_m = 0.0005", "marker_m = 0.0005\nrange_m = 0.005");
  const auto at = mixed.find("distance_m = 0.865700");
  ASSERT_NE(at, std::string::npos);
  mixed.replace(at, 21, "distance_m = 1.865700");
  EXPECT_NE(error_of(mixed).find("do not determine the camera's"), std::string::npos)
      << error_of(mixed);
  EXPECT_EQ(read_external("/nowhere/x.toml").error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace mixrig::mocap

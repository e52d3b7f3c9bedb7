// SPDX-License-Identifier: Apache-2.0
// Recorded fisheyes whose image is a circle inside the picture: the circle, and the lens from all
// views, from halves of them, and from those near the rim.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/calibrate/intrinsics/intrinsics.h"
#include "host/calibrate/intrinsics/uncertainty.h"
#include "host/math/image_io/image_io.h"

namespace mixrig::calibration {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;
using Eigen::Vector3d;
using geometry::AnyCamera;
using geometry::LensKind;

constexpr double kDegree = M_PI / 180;

std::optional<fs::path> fisheye_recording(const std::string& name) {
  const char* data = std::getenv("MIXRIG_DATA");
  if (data == nullptr || !fs::is_directory(fs::path(data) / name)) return std::nullopt;
  return fs::path(data) / name;
}

struct FisheyeSet {
  BoardSpec board;
  Size size_px;
  std::vector<ObservedView> views;
  std::optional<ImageCircle> circle;
};

FisheyeSet read_set(const fs::path& folder, const std::string& prefix, const char* board) {
  FisheyeSet set;
  set.board = *parse_board(board);
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().filename().string().starts_with(prefix)) paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  BrightestPicture brightest;
  for (const auto& path : paths) {
    Image<Rgb8> color;
    if (!image_io::read_rgb8(path, color)) continue;
    const auto gray = gray_of(color);
    set.size_px = gray.size();
    brightest.add(gray.view());
    if (const auto seen = detect_board(gray, set.board); seen && *seen)
      set.views.push_back({path.filename().string(), **seen});
  }
  set.circle = find_image_circle(brightest.image());
  return set;
}

std::vector<ObservedView> half_of(const FisheyeSet& set, std::size_t from) {
  std::vector<ObservedView> half;
  for (std::size_t i = from; i < set.views.size(); i += 2) half.push_back(set.views[i]);
  return half;
}

/// The views whose points lie farthest from the circle's centre, in the mean.
std::vector<ObservedView> nearest_to_rim(const FisheyeSet& set, std::size_t count) {
  std::vector<std::pair<double, ObservedView>> all;
  for (const ObservedView& view : set.views) {
    double sum = 0;
    for (const Vector2d& px : view.board.px) sum += (px - set.circle->center_px).norm();
    all.emplace_back(-sum / static_cast<double>(view.board.px.size()), view);
  }
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<ObservedView> views;
  for (std::size_t i = 0; i < std::min(count, all.size()); ++i) views.push_back(all[i].second);
  return views;
}

Result<Intrinsics> fit(const FisheyeSet& set, const std::vector<ObservedView>& views,
                       bool with_circle, int terms = -1) {
  IntrinsicsOptions options;
  options.kind = LensKind::kFisheye;
  options.lens_terms = terms;
  if (with_circle) options.circle = set.circle;
  return solve_intrinsics(set.board, set.size_px, views, options);
}

/// The lens without its image circle, so that it is checked in the whole picture.
AnyCamera without_circle(const Intrinsics& found) {
  return geometry::make_camera(LensKind::kFisheye, geometry::size_px(found.camera),
                               found.bundle.intrinsics);
}

/// Prints one line about a fit, and the result of a check of its lens in the whole picture.
void tell(const std::string& name, const Result<Intrinsics>& found) {
  if (!found) {
    std::printf("%s: %s\n", name.c_str(), found.error().context.c_str());
    return;
  }
  const auto valid = geometry::validate(without_circle(*found));
  const UncertaintyMap map = projection_uncertainty(*found, 12, 9);
  std::printf(
      "%s: %d terms, fx %.2f, %zu views, rms %.4f, held out %.4f px, points to %.1f deg, "
      "used to %.1f deg; uncertain by %.3f px in the median, %.3f at worst; without a "
      "circle: %s\n",
      name.c_str(), found->lens_terms, found->bundle.intrinsics[0], found->bundle.views.size(),
      found->rms_px, found->held_out_px, found->point_angle_rad / kDegree,
      geometry::max_angle_rad(found->camera).value_or(M_PI) / kDegree, map.median_px, map.worst_px,
      valid ? "valid" : valid.error().context.c_str());
}

/// Held-out error: each half in turn is held out, and only the poses are fitted to it.
double halves_held_out_px(const FisheyeSet& set) {
  double squares = 0;
  for (const std::size_t from : {std::size_t{0}, std::size_t{1}}) {
    const auto found = fit(set, half_of(set, from), true);
    tell("  half " + std::to_string(from), found);
    EXPECT_TRUE(found) << found.error().context;
    if (!found) return 1e9;
    squares +=
        0.5 * std::pow(pose_only_rms_px(found->camera, set.board, half_of(set, 1 - from)), 2);
  }
  return std::sqrt(squares);
}

/// Mean angle by which rays of `ours` lie farther from the axis than those of `reference`.
double farther_out_deg(const AnyCamera& ours, const AnyCamera& reference, double theta_deg) {
  const double theta = theta_deg * kDegree;
  double sum = 0;
  int count = 0;
  for (double phi = 0; phi < 6.2; phi += 0.3, ++count) {
    const Vector3d ray(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                       std::cos(theta));
    const auto px = geometry::project(reference, ray);
    const auto back = px ? geometry::unproject(ours, *px) : std::nullopt;
    sum += back ? std::atan2(back->head<2>().norm(), back->z()) - theta : NAN;
  }
  return sum / count / kDegree;
}

AnyCamera reference_lens(const fs::path& path, Size size) {
  std::ifstream file(path);
  const auto json = nlohmann::json::parse(file);
  const auto &k = json["K"], &d = json["k1..k4"];
  Eigen::VectorXd v(8);
  v << k[0][0], k[1][1], k[0][2], k[1][2], d[0], d[1], d[2], d[3];
  return geometry::make_camera(LensKind::kFisheye, size, v);
}

TEST(RealFisheyes, MovingCamera) {
  const auto folder = fisheye_recording("fisheye-moving-camera");
  if (!folder) GTEST_SKIP() << "no recording fisheye-moving-camera: set MIXRIG_DATA";
  const FisheyeSet set = read_set(*folder, "Fisheye2", "checkerboard:8x6:117mm");
  ASSERT_TRUE(set.circle);
  EXPECT_NEAR(set.circle->radius_px, 288, 3);
  EXPECT_LT((set.circle->center_px - Vector2d(382.5, 239.3)).norm(), 2);
  const auto all = fit(set, set.views, true), rim = fit(set, nearest_to_rim(set, 6), true);
  tell("moving: all", all);
  tell("moving: six views nearest to the rim", rim);
  ASSERT_TRUE(all && rim);
  EXPECT_LT(all->held_out_px, 0.11);
  EXPECT_NEAR(*geometry::max_angle_rad(all->camera) / kDegree, 88.7, 1);
  EXPECT_LT(projection_uncertainty(*all, 12, 9).worst_px, 1);
  EXPECT_LT(std::abs(farther_out_deg(rim->camera, all->camera, 85)), 0.3);
  EXPECT_LT(halves_held_out_px(set), 0.12);
  // With two terms the lens folds between the circle and the sides of the picture.
  const auto two = fit(set, set.views, true, 2);
  tell("moving: two terms", two);
  ASSERT_TRUE(two);
  EXPECT_FALSE(geometry::validate(without_circle(*two)));
  EXPECT_LT(std::abs(farther_out_deg(two->camera, all->camera, 85)), 0.3);
  // An independent solution from eleven of the pictures.
  const AnyCamera reference =
      reference_lens(*folder / "reference_opencv_fisheye.json", set.size_px);
  for (const int theta_deg : {15, 30, 45, 60}) {
    const double off = farther_out_deg(all->camera, reference, theta_deg);
    std::printf("moving: %d degrees of the reference lie %.3f degrees farther out\n", theta_deg,
                off);
    EXPECT_LT(std::abs(off), 0.15);
  }
  const double theirs = pose_only_rms_px(reference, set.board, set.views);
  std::printf("moving: poses fitted to our corners with the reference %.4f px\n", theirs);
  EXPECT_LT(all->rms_px, theirs);
}

/// Four of the ten views nearest to the rim. Without the image circle they are refused at every
/// number of terms, since no lens reaches the sides of the picture.
TEST(RealFisheyes, FewViewsNearTheRim) {
  const auto folder = fisheye_recording("fisheye-moving-camera");
  if (!folder) GTEST_SKIP() << "no recording fisheye-moving-camera: set MIXRIG_DATA";
  const FisheyeSet set = read_set(*folder, "Fisheye2", "checkerboard:8x6:117mm");
  ASSERT_TRUE(set.circle);
  constexpr std::size_t kPool = 10, kUsed = 4;
  constexpr int kDraws = 12;
  std::vector<ObservedView> pool = nearest_to_rim(set, kPool);
  std::mt19937 random(1);
  int refused_before = 0;
  double worst_px = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    for (std::size_t i = 0; i < kUsed; ++i) std::swap(pool[i], pool[i + random() % (kPool - i)]);
    const auto used = pool.begin() + kUsed;
    const std::vector<ObservedView> views(pool.begin(), used), others(used, pool.end());
    const auto before = fit(set, views, false), now = fit(set, views, true);
    refused_before += !before || before->ends_at_points ? 1 : 0;
    ASSERT_TRUE(now) << draw << ": " << now.error().context;
    worst_px = std::max(worst_px, pose_only_rms_px(now->camera, set.board, others));
  }
  std::printf(
      "moving: four views near the rim: %d of %d draws were refused, worst held out %.3f px\n",
      refused_before, kDraws, worst_px);
  EXPECT_GE(refused_before, 3);
  EXPECT_LT(worst_px, 0.25);
}

void circular_side(const fs::path& folder, const char* side, double most_held_out_px) {
  const FisheyeSet set = read_set(folder, side, "checkerboard:9x6:24.23mm");
  ASSERT_TRUE(set.circle);
  EXPECT_NEAR(set.circle->radius_px, 381.3, 3);
  const auto all = fit(set, set.views, true);
  tell(side, all);
  ASSERT_TRUE(all);
  EXPECT_NEAR(*geometry::max_angle_rad(all->camera) / kDegree, 90.7, 3);
  EXPECT_LT(projection_uncertainty(*all, 12, 9).worst_px, 2);
  EXPECT_LT(halves_held_out_px(set), most_held_out_px);
  // Points end at 63 degrees, and four terms turn back soon after.
  const auto four = fit(set, set.views, true, 4);
  ASSERT_FALSE(four);
  EXPECT_NE(four.error().context.find("folds inside its image circle"), std::string::npos)
      << four.error().context;
}

TEST(RealFisheyes, StereoLeft) {
  const auto folder = fisheye_recording("fisheye-stereo-checkerboard");
  if (!folder) GTEST_SKIP() << "no recording fisheye-stereo-checkerboard: set MIXRIG_DATA";
  circular_side(*folder, "left", 0.17);
}

TEST(RealFisheyes, StereoRight) {
  const auto folder = fisheye_recording("fisheye-stereo-checkerboard");
  if (!folder) GTEST_SKIP() << "no recording fisheye-stereo-checkerboard: set MIXRIG_DATA";
  circular_side(*folder, "right", 0.185);
}

// One dark picture does not show the circle, and lamps in it are not taken for its rim.
TEST(RealFisheyes, OnePictureOfADarkRoom) {
  const auto folder = fisheye_recording("fisheye-room-lights");
  if (!folder) GTEST_SKIP() << "no recording fisheye-room-lights: set MIXRIG_DATA";
  for (const char* name : {"t265_fs1.png", "t265_fs2.png", "t265_robot1.png", "t265_robot2.png",
                           "tumvi_room_cam0.png"}) {
    Image<Rgb8> color;
    ASSERT_TRUE(image_io::read_rgb8(*folder / name, color)) << name;
    const auto gray = gray_of(color);
    const auto found = find_image_circle(gray.view());
    EXPECT_FALSE(found) << name << ": radius " << found->radius_px;
  }
}

}  // namespace
}  // namespace mixrig::calibration

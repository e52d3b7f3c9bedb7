// SPDX-License-Identifier: Apache-2.0
// Kinect v2, infrared and colour: the published corners must give the published calibration, camera
// by camera and both together.
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <Eigen/LU>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/calibrate/intrinsics/intrinsics.h"
#include "host/calibrate/rig/rig_terms.h"
#include "host/math/estimation/verdict.h"

namespace mixrig::calibration {
namespace {

namespace fs = std::filesystem;

constexpr Size kIr_px{512, 424}, kColor_px{1920, 1080};

std::optional<nlohmann::json> published_file(const char* name) {
  const char* data = std::getenv("MIXRIG_DATA");
  if (data == nullptr) return std::nullopt;
  std::ifstream file(fs::path(data) / "kinect2-ir-color-checkerboard" / name);
  if (!file) return std::nullopt;
  return nlohmann::json::parse(file);
}
#define PUBLISHED_OR_SKIP(variable, name)     \
  const auto variable = published_file(name); \
  if (!variable) GTEST_SKIP() << "no recording kinect2-ir-color-checkerboard: set MIXRIG_DATA"

/// Views of one camera in corners.json; `key` is ir_px or color_px.
std::vector<ObservedView> published_corners(const nlohmann::json& json, const char* key) {
  std::vector<ObservedView> views;
  for (const auto& [name, view] : json.items()) {
    if (!view.contains(key) || !view.contains("object_mm")) continue;
    ObservedView seen;
    seen.name = name;
    for (std::size_t i = 0; i < view[key].size(); ++i) {
      const auto& m = view["object_mm"][i];
      seen.board.ids.push_back(
          static_cast<int>(m[1].get<double>() / 40 * 5 + m[0].get<double>() / 40));
      seen.board.px.emplace_back(view[key][i][0].get<double>(), view[key][i][1].get<double>());
    }
    views.push_back(seen);
  }
  return views;
}

Intrinsics solve_alone(const BoardSpec& board, Size size_px,
                       const std::vector<ObservedView>& views) {
  IntrinsicsOptions options;  // as published: centre held, no k3
  options.hold_center = true;
  options.lens_terms = 4;
  const auto found = solve_intrinsics(board, size_px, views, options);
  if (!found) {
    ADD_FAILURE() << found.error().context;
    return {};
  }
  const auto& v = found->bundle.intrinsics;
  std::printf("alone: fx %.3f +- %.3f fy %.3f, %.4f px RMS, %d of %d points left out, %zu views\n",
              v[0], std::sqrt(found->covariance(0, 0)), v[1], found->rms_px, found->points_out,
              found->points + found->points_out, found->bundle.views.size());
  return *found;
}

TEST(Kinect2, EachCameraIsAsPublished) {
  PUBLISHED_OR_SKIP(json, "corners.json");
  const BoardSpec board = *parse_board("checkerboard:5x7:40mm");
  const Intrinsics ir = solve_alone(board, kIr_px, published_corners(*json, "ir_px")),
                   color = solve_alone(board, kColor_px, published_corners(*json, "color_px"));
  EXPECT_NEAR(ir.bundle.intrinsics[0], 364.13, 2.62);
  EXPECT_NEAR(ir.bundle.intrinsics[1], 365.13, 2.81);
  EXPECT_NEAR(color.bundle.intrinsics[0], 1062.33, 2.91);
  EXPECT_NEAR(color.bundle.intrinsics[1], 1066.52, 3.05);
}

RigCamera rig_camera(const char* name, Size size_px, const Intrinsics& found) {
  RigCamera camera;
  camera.name = name;
  camera.size_px = size_px;
  camera.parameters = found.bundle.intrinsics;
  camera.free = found.bundle.free;
  return camera;
}

/// Corners by view, infrared then colour, on a board of 6 x 8 squares.
SeenCorners both_cameras(const std::vector<ObservedView>& ir,
                         const std::vector<ObservedView>& color) {
  SeenCorners all;
  for (std::size_t v = 0; v < ir.size(); ++v) {
    all.emplace_back(2);
    for (std::size_t c = 0; c < 2; ++c) {
      const BoardView& seen = (c == 0 ? ir : color)[v].board;
      for (std::size_t i = 0; i < seen.ids.size(); ++i)
        all[v][c].push_back({{seen.ids[i] % 5 + 1.0, seen.ids[i] / 5 + 1.0}, seen.px[i]});
    }
  }
  return all;
}

/// The joint fit that `calibrate rig` starts from: both lenses, the way from one camera to the
/// other and the board's places at once.
TEST(Kinect2, BothTogetherGiveThePublishedMounting) {
  PUBLISHED_OR_SKIP(json, "corners.json");
  PUBLISHED_OR_SKIP(published, "published_calibration.json");
  const BoardSpec board = *parse_board("checkerboard:5x7:40mm");
  const auto ir_views = published_corners(*json, "ir_px"),
             color_views = published_corners(*json, "color_px");
  ASSERT_EQ(ir_views.size(), 9U);
  ASSERT_EQ(color_views.size(), 9U);
  const Intrinsics ir = solve_alone(board, kIr_px, ir_views),
                   color = solve_alone(board, kColor_px, color_views);
  RigModel model;
  model.square_m = 0.04;
  model.cameras = {rig_camera("tof", kIr_px, ir), rig_camera("color", kColor_px, color)};
  // Corner (1, 1) in squares is the first point of the board that a camera alone was fitted to.
  const geometry::Pose inner_from_outer{Eigen::Quaterniond::Identity(), {-0.04, -0.04, 0}};
  for (std::size_t v = 0; v < ir_views.size(); ++v)
    model.target_from_board.push_back(ir.views[v].camera_from_board * inner_from_outer);
  model.cameras[1].camera_from_target =
      color.views[0].camera_from_board * geometry::inverse(ir.views[0].camera_from_board);

  const SeenCorners corners = both_cameras(ir_views, color_views);
  BoardPrint print;
  print.columns = 6, print.rows = 8;
  std::vector<int> views;
  for (int v = 0; v < 9; ++v) views.push_back(v);
  Crew crew(1);
  const RigLayout layout = layout_of(model, {});
  // One coordinate's sigma is the published 0.264 to 0.305 px: the answer's covariance follows.
  const SolveReport solved = solve_views(model, layout, corner_terms(print, corners, {0.27, 0.28}),
                                         views, {100, 1e-12, {}}, crew);
  ASSERT_TRUE(solved.solved);

  const auto& stereo = (*published)["stereo_after_joint_optimisation"];
  const geometry::Pose& found = model.cameras[1].camera_from_target;
  const int at = layout.cameras[1].extrinsics;
  const Eigen::Vector3d mm = 1e3 * found.translation_m,
                        sigma_mm =
                            1e3 * solved.covariance.diagonal().segment<3>(at + 3).cwiseSqrt();
  Eigen::Matrix3d rotation;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) rotation(r, c) = stereo["R_color_from_ir"][r][c].get<double>();
  const double turned_deg =
      found.rotation.angularDistance(Eigen::Quaterniond(rotation)) * 180 / M_PI;
  std::printf(
      "kinect2 joint: T %.2f %.2f %.2f +- %.2f %.2f %.2f mm, turned %.4f deg from the published, "
      "fx %.3f %.3f, rms %.4f px of a coordinate (in sigmas)\n",
      mm.x(), mm.y(), mm.z(), sigma_mm.x(), sigma_mm.y(), sigma_mm.z(), turned_deg,
      model.cameras[0].parameters[0], model.cameras[1].parameters[0],
      std::sqrt(solved.cost / static_cast<double>(solved.rows)));
  const Eigen::Vector3d published_mm(-52.20, -0.26, 0.63), published_sigma_mm(0.33, 0.32, 1.01);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(mm[axis], published_mm[axis], published_sigma_mm[axis]) << axis;
    // Theirs comes from the same corners; the toolbox states three sigmas.
    EXPECT_NEAR(3 * sigma_mm[axis], published_sigma_mm[axis], 0.5 * published_sigma_mm[axis])
        << axis;
  }
  EXPECT_LT(turned_deg, 0.1);
  EXPECT_NEAR(model.cameras[0].parameters[0], 364.13, 2.62);
  EXPECT_NEAR(model.cameras[1].parameters[0], 1062.33, 2.91);
}

}  // namespace
}  // namespace mixrig::calibration

// SPDX-License-Identifier: Apache-2.0
// Clicks on surfaces of four rooms that other people recorded. Where they are was said by looking
// at the pictures: clicks of one line lie on one flat surface. The truth of a click is the plane
// through the depths under the line's clicks, each the mean of a small square.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "hal/base/angles.h"
#include "hal/base/order_statistics.h"
#include "host/math/image_io/image_io.h"
#include "host/room/click/clicked_plane.h"

namespace mixrig::model {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

struct Surface {
  const char* name;
  std::vector<Vector2d> clicks_px;
};
struct Recorded {
  const char* depth;
  geometry::Pinhole camera;
  std::vector<Surface> surfaces;
  std::vector<Vector2d> not_flat_px;  ///< cloth, a jacket, a chair
};

const geometry::Pinhole kXtion{{640, 480}, 567.9, 568.9, 312.1, 242.6};
const geometry::Pinhole kKinect{{640, 480}, 585, 585, 320, 240};

const std::vector<Recorded>& recordings() {
  static const std::vector<Recorded> all{
      {"rgbd-xtion-static/lab_queue/depth/0010.png",
       kXtion,
       {{"floor", {{120, 200}, {180, 250}, {110, 270}, {200, 330}, {120, 330}, {220, 400}}}},
       {{410, 420}, {440, 390}}},
      {"rgbd-xtion-static/room_two_cams/cam1/depth/0005.png", kXtion, {}, {{240, 210}, {265, 260}}},
      {"rgbd-xtion-static/room_two_cams/cam2/depth/0005.png",
       kXtion,
       {{"whiteboard", {{100, 240}, {160, 330}, {60, 380}, {165, 240}, {60, 220}}},
        {"ceiling", {{200, 100}, {300, 60}, {420, 60}, {400, 150}, {250, 150}}}},
       {{500, 350}, {550, 400}}},
      {"rgbd-kitchen-moving-camera/frame-000150.depth.png",
       kKinect,
       {{"cabinets", {{190, 360}, {280, 310}, {220, 410}, {300, 300}, {350, 270}}}},
       {{500, 440}}}};
  return all;
}

/// The mean depth of a small square, without what is far from its median; 0 where half of it is
/// unknown.
double depth_at(const Image<float>& depth_m, const Vector2d& px) {
  constexpr int kHalf = 7;
  std::vector<double> known;
  for (int dy = -kHalf; dy <= kHalf; ++dy)
    for (int dx = -kHalf; dx <= kHalf; ++dx) {
      const double z = depth_m.at(static_cast<int>(px.x()) + dx, static_cast<int>(px.y()) + dy);
      if (z > 0) known.push_back(z);
    }
  constexpr std::size_t kLeast = (2 * kHalf + 1) * (2 * kHalf + 1) / 2;
  if (known.size() < kLeast) return 0;
  const double middle = upper_median_in_place(std::span(known));
  double sum = 0, count = 0;
  for (const double z : known)
    if (std::abs(z - middle) < 0.04 * middle) sum += z, count += 1;
  return sum / count;
}

/// The plane of least squares through points: its unit normal and a point.
std::pair<Vector3d, Vector3d> plane_through(const std::vector<Vector3d>& points) {
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& p : points) mean += p / static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vector3d& p : points) spread += (p - mean) * (p - mean).transpose();
  return {Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(0), mean};
}

void try_surface(const ClickPicture& picture, const Image<float>& depth_m, const Surface& surface) {
  std::vector<Vector3d> points;
  for (const Vector2d& px : surface.clicks_px)
    if (const double z = depth_at(depth_m, px); z > 0)
      points.push_back(z * picture.view.unproject(px).homogeneous());
  ASSERT_GE(points.size(), 3U) << surface.name;
  const auto [normal, middle] = plane_through(points);
  for (const Vector2d& px : surface.clicks_px) {
    SCOPED_TRACE(surface.name + (" " + std::to_string(px.x())) + " " + std::to_string(px.y()));
    const auto found = plane_under(picture, {px, std::nullopt});
    const auto* const plane = std::get_if<ClickedPlane>(&found);
    if (plane == nullptr) {
      ADD_FAILURE() << text_of(std::get<ClickRefusal>(found));
      continue;
    }
    EXPECT_LT(std::acos(std::min(1.0, std::abs(normal.dot(plane->plane.normal)))) / kDeg, 5);
    EXPECT_LT(std::abs(normal.dot(plane->point_m - middle)), 0.01 * plane->point_m.z());
  }
}

/// The takes state no noise, so that the default stands for it.
TEST(RealClicks, SurfacesOfRecordedRoomsAreFoundAndClothIsRefused) {
  const char* const data = std::getenv("MIXRIG_DATA");
  if (data == nullptr) GTEST_SKIP() << "needs recordings: set MIXRIG_DATA";
  for (const Recorded& recorded : recordings()) {
    Image<std::uint16_t> steps;
    ASSERT_TRUE(image_io::read_gray16(std::filesystem::path(data) / recorded.depth, steps));
    Image<float> depth_m(steps.size());
    for (int y = 0; y < steps.height(); ++y)
      for (int x = 0; x < steps.width(); ++x)
        depth_m.at(x, y) =
            0.001F * static_cast<float>(steps.at(x, y) == 65535 ? 0 : steps.at(x, y));
    const geometry::CameraModel tof{recorded.camera, {}};
    const ClickPicture picture{depth_m, &tof, false, {}, recorded.camera, {}};
    for (const Surface& surface : recorded.surfaces) try_surface(picture, depth_m, surface);
    for (const Vector2d& px : recorded.not_flat_px) {
      const auto found = plane_under(picture, {px, std::nullopt});
      EXPECT_TRUE(std::holds_alternative<ClickRefusal>(found))
          << recorded.depth << " " << px.transpose();
    }
  }
}

}  // namespace
}  // namespace mixrig::model

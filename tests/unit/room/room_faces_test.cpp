// SPDX-License-Identifier: Apache-2.0
// Faces of a cube from panoramas that have a formula; rays by hand.
#include "host/room/scan/shape/room_faces.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include <gtest/gtest.h>

#include "hal/base/learned_color.h"

namespace mixrig::model {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

constexpr int kRows = 180;
const Vector3d kBox_m(2.5, 2.0, 1.5);  ///< half of it; the origin is in its middle

double to_cube_wall_m(const Vector3d& ray) {
  double nearest = 1e9;
  for (int k = 0; k < 3; ++k) nearest = std::min(nearest, kBox_m[k] / std::abs(ray[k]));
  return nearest;
}

/// Azimuth counter-clockwise from y, elevation up to z.
Vector3d ray_at(double azimuth, double elevation) {
  return {-std::sin(azimuth) * std::cos(elevation), std::cos(azimuth) * std::cos(elevation),
          std::sin(elevation)};
}

using Distance = std::function<double(const Vector3d&)>;

/// Colour: a byte for each axis of the ray.
Panorama panorama_of(const Distance& distance_m, int factor = 1) {
  const Size size{2 * kRows, kRows};
  Panorama p{Image<float>(size), Image<float>(size, 0.004F), Image<std::uint8_t>(size, 1),
             Image<std::uint8_t>(size, 1), Image<Rgb8>({factor * 2 * kRows, factor * kRows})};
  const auto ray = [](Size of, int x, int y) {
    return ray_at(pi * (1 - 2 * (x + 0.5) / of.width), pi * (0.5 - (y + 0.5) / of.height));
  };
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      p.distance_m.at(x, y) = static_cast<float>(distance_m(ray(size, x, y)));
  for (int y = 0; y < p.color.height(); ++y)
    for (int x = 0; x < p.color.width(); ++x) {
      const Vector3d r = ray(p.color.size(), x, y);
      const auto byte = [](double v) {
        return static_cast<std::uint8_t>(std::lround(128 + 100 * v));
      };
      p.color.at(x, y) = {byte(r.x()), byte(r.y()), byte(r.z())};
    }
  return p;
}

RoomFaces faces_of(const Panorama& panorama) {
  Crew crew(2);
  return make_faces(panorama, crew);
}

/// Direction of a face's pixel, 1 long along its axis.
Vector3d ray_of(const RoomFaces& faces, std::size_t face, double x, double y) {
  const auto& c = faces.camera;
  return faces.base_from_face[face].rotation *
         Vector3d((x - c.cx_px) / c.fx_px, (y - c.cy_px) / c.fy_px, 1);
}

TEST(RoomFaces, HoldTheBoxInAllDirections) {
  const RoomFaces faces = faces_of(panorama_of(to_cube_wall_m));
  ASSERT_EQ(faces.base_from_face.size(), 6U);
  const int side = faces.camera.size_px.width;
  ASSERT_EQ(faces.depth_m.size(), (Size{side, 6 * side}));
  double worst = 0;
  int near_edges = 0;
  for (std::size_t face = 0; face < 6; ++face)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const double z_m = to_cube_wall_m(ray_of(faces, face, x, y));
        const double error = std::abs(faces.depth_m.at(x, static_cast<int>(face) * side + y) - z_m);
        // Where two walls meet, an interpolated pixel cuts the corner.
        if (error > 0.001)
          ++near_edges;
        else
          worst = std::max(worst, error);
        ASSERT_LT(error, 0.03);
      }
  EXPECT_LT(worst, 0.001);
  EXPECT_LT(near_edges, 0.06 * 6 * side * side);
}

TEST(RoomFaces, OverlapAroundTheWholeCube) {
  const RoomFaces faces = faces_of(panorama_of(to_cube_wall_m));
  // The corners of the cube, and the middles of its edges, lie two pixels inside of each face.
  const double reach =
      (faces.camera.size_px.width - 1 - faces.camera.cx_px - 2) / faces.camera.fx_px;
  EXPECT_GT(reach, 1.0);
  Vector3d sum = Vector3d::Zero();
  for (const geometry::Pose& pose : faces.base_from_face) {
    sum += pose.rotation * Vector3d::UnitZ();
    EXPECT_EQ(pose.translation_m, Vector3d::Zero());
    EXPECT_NEAR(pose.rotation.norm(), 1, 1e-12);
  }
  EXPECT_LT(sum.norm(), 1e-12) << "an axis for each direction";
}

TEST(RoomFaces, ThatSeeNothingAreLeftOutAndTheUnknownStaysUnknown) {
  const RoomFaces faces = faces_of(panorama_of([](const Vector3d& ray) {
    return std::abs(ray.x()) < 0.4 * ray.y() && std::abs(ray.z()) < 0.4 * ray.y() ? 3.0 : 0.0;
  }));
  ASSERT_EQ(faces.base_from_face.size(), 1U);
  const int side = faces.camera.size_px.width;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const Vector3d ray = ray_of(faces, 0, x, y);
      const double off = std::max(std::abs(ray.x()), std::abs(ray.z())) / ray.y();
      const float z_m = faces.depth_m.at(x, y);
      if (off > 0.43) {
        EXPECT_EQ(z_m, 0);
      } else if (off < 0.37) {
        EXPECT_NEAR(z_m, 3.0 / ray.norm(), 0.001);
      }
    }
}

TEST(RoomFaces, NothingIsMadeUpAtADepthStep) {
  const RoomFaces faces =
      faces_of(panorama_of([](const Vector3d& ray) { return ray.x() > 0.2 ? 1.5 : 3.0; }));
  const int side = faces.camera.size_px.width;
  for (int y = 0; y < faces.depth_m.height(); ++y)
    for (int x = 0; x < side; ++x) {
      const Vector3d ray = ray_of(faces, static_cast<std::size_t>(y / side), x, y % side);
      const double distance_m = faces.depth_m.at(x, y) * ray.norm();
      EXPECT_TRUE(std::abs(distance_m - 1.5) < 0.001 || std::abs(distance_m - 3.0) < 0.001)
          << distance_m;
    }
}

TEST(RoomFaces, ColourHasItsOwnResolution) {
  for (const int factor : {1, 3}) {
    const RoomFaces faces = faces_of(panorama_of(to_cube_wall_m, factor));
    ASSERT_EQ(faces.color_factor, factor);
    const int side = factor * faces.camera.size_px.width;
    ASSERT_EQ(faces.color.size(), (Size{side, 6 * side}));
    for (std::size_t face = 0; face < 6; ++face)
      for (int y = 0; y < side; y += 7)
        for (int x = 0; x < side; x += 7) {
          const Vector3d ray =
              ray_of(faces, face, (x + 0.5) / factor - 0.5, (y + 0.5) / factor - 0.5).normalized();
          const Rgbx8 c = faces.color.at(x, static_cast<int>(face) * side + y);
          EXPECT_NEAR(c.r, 128 + 100 * ray.x(), 2.0);
          EXPECT_NEAR(c.g, 128 + 100 * ray.y(), 2.0);
          EXPECT_NEAR(c.b, 128 + 100 * ray.z(), 2.0);
          EXPECT_LT(c.x, 6) << "it changes slowly";
        }
  }
}

TEST(RoomFaces, SpreadIsLargeAtBordersOfColourAndUnknownIsSaid) {
  Panorama p = panorama_of(to_cube_wall_m);
  for (int y = 0; y < kRows; ++y)
    for (int x = 0; x < 2 * kRows; ++x)
      p.color.at(x, y) = x < kRows ? Rgb8{255, 255, 255} : Rgb8{60, 60, 60};
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 2 * kRows; ++x) p.color.at(x, y) = {};  // around the zenith
  const RoomFaces faces = faces_of(p);
  const int side = faces.camera.size_px.width, middle = side / 2;
  // The first face looks ahead; its middle column is the border.
  EXPECT_GT(faces.color.at(middle, middle).x, 100);
  EXPECT_LT(faces.color.at(middle - 10, middle).x, 3);
  EXPECT_LT(faces.color.at(middle + 10, middle).x, 3);
  EXPECT_EQ(faces.color.at(middle, 4 * side + middle).x, kUnknownColorByte) << "up";
}

/// Only changed pixels of the faces come back, at their direction and with their distance.
TEST(RoomFaces, GiveTheirChangesBackToThePanorama) {
  Panorama panorama = panorama_of(to_cube_wall_m, 2);
  const Panorama as_it_was = panorama;
  const RoomFaces before = faces_of(panorama);
  RoomFaces after = before;
  const int middle = (before.camera.size_px.width - 1) / 2;
  for (int y = middle - 12; y <= middle + 12; ++y)
    for (int x = middle - 8; x <= middle + 8; ++x) {
      after.depth_m.at(x, y) = x < middle ? 1.25F : 0.0F;
      after.depth_sigma_m.at(x, y) = x < middle ? 0.01F : 0.0F;
      for (const int fine_y : {2 * y, 2 * y + 1})
        for (const int fine_x : {2 * x, 2 * x + 1})
          after.color.at(fine_x, fine_y) =
              x < middle ? Rgbx8{10, 200, 30, 0} : Rgbx8{0, 0, 0, kUnknownColorByte};
    }
  take_changes(before, after, panorama);
  int nearer = 0, forgotten = 0;
  for (int y = 0; y < panorama.size().height; ++y)
    for (int x = 0; x < panorama.size().width; ++x) {
      const float now_m = panorama.distance_m.at(x, y);
      const Vector3d ray = direction_of(panorama.size(), x, y);
      if (now_m == as_it_was.distance_m.at(x, y)) continue;
      ASSERT_LT(std::atan(std::hypot(ray.x(), ray.z()) / ray.y()), 0.3) << "the face looks ahead";
      if (now_m > 0) {
        ++nearer;
        EXPECT_NEAR(now_m * ray.y(), 1.25, 1e-5);
        EXPECT_FLOAT_EQ(panorama.sigma_m.at(x, y), static_cast<float>(0.01 / ray.y()));
        EXPECT_LT(ray.x(), 0.02) << "the left half";
      } else {
        ++forgotten;
        EXPECT_EQ(panorama.views.at(x, y), 0);
      }
    }
  // The panorama has an even number of pixels, the face an odd one.
  EXPECT_NEAR(nearer, 8 * 24, 20);
  EXPECT_NEAR(forgotten, 8 * 24, 20);
  const int ahead = 2 * kRows;  // column of the colour
  EXPECT_EQ(panorama.color.at(ahead - 8, kRows), (Rgb8{10, 200, 30}));
  EXPECT_EQ(panorama.color.at(ahead + 6, kRows), Rgb8{});
  EXPECT_EQ(panorama.color.at(ahead + 100, kRows), as_it_was.color.at(ahead + 100, kRows));
}

}  // namespace
}  // namespace mixrig::model

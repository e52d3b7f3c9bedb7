// SPDX-License-Identifier: Apache-2.0
#include "host/room/registration/plane_guesses.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <Eigen/LU>

#include "hal/base/angles.h"
#include "host/math/estimation/decompositions.h"

namespace mixrig::model {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr std::size_t kMostPlanes = 10;
constexpr double kLeastVolume = 0.3;         ///< of three unit normals
constexpr double kSameAngle = 0.05;          ///< of cosines: 3 degrees
constexpr double kMostTilt_rad = 25 * kDeg;  ///< between the z axes: heads of tripods
constexpr double kMostShift_m = 50;

/// Three planes: unit normals as columns, and distances from the origin.
struct Triple {
  Matrix3d normals;
  Vector3d away_m;
};

std::vector<Triple> triples_of(const std::vector<RoomPlane>& planes, bool ordered) {
  std::vector<Triple> triples;
  const std::size_t n = std::min(planes.size(), kMostPlanes);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = ordered ? 0 : i + 1; j < n; ++j)
      for (std::size_t k = ordered ? 0 : j + 1; k < n; ++k) {
        if (i == j || j == k || i == k) continue;
        Triple t;
        Eigen::Index column = 0;
        for (const std::size_t of : {i, j, k}) {
          const Vector3d& w = planes[of].inverse_per_m;
          t.normals.col(column) = w.normalized();
          t.away_m[column++] = 1 / w.norm();
        }
        if (std::abs(t.normals.determinant()) > kLeastVolume) triples.push_back(t);
      }
  return triples;
}

std::optional<geometry::Pose> pose_of(const Triple& a, const Triple& b) {
  if (a.normals.determinant() * b.normals.determinant() <= 0) return {};
  const Matrix3d angles = a.normals.transpose() * a.normals - b.normals.transpose() * b.normals;
  if (angles.cwiseAbs().maxCoeff() > kSameAngle) return {};
  // Kabsch 1976.
  const estimation::SingularValues svd =
      estimation::singular_values_of(a.normals * b.normals.transpose());
  Vector3d signs(1, 1, 1);
  signs[2] = (svd.u * svd.v.transpose()).determinant() < 0 ? -1 : 1;
  const Matrix3d rotation = svd.u * signs.asDiagonal() * svd.v.transpose();
  if (rotation(2, 2) < std::cos(kMostTilt_rad)) return {};
  const Vector3d shift_m = a.normals.transpose().inverse() * (a.away_m - b.away_m);
  if (!(shift_m.norm() < kMostShift_m)) return {};
  return geometry::Pose{Eigen::Quaterniond(rotation).normalized(), shift_m};
}

/// Floor and a wall: columns of `normals` are both and the direction along the wall.
std::vector<Triple> floors_and_walls(const std::vector<RoomPlane>& planes) {
  constexpr double kFlat = 0.8, kUpright = 0.35;
  constexpr std::size_t kMostWalls = 4;
  const auto normal = [](const RoomPlane& p) -> Vector3d { return p.inverse_per_m.normalized(); };
  const auto floor = std::find_if(planes.begin(), planes.end(),
                                  [&](const RoomPlane& p) { return normal(p).z() < -kFlat; });
  std::vector<Triple> pairs;
  if (floor == planes.end()) return pairs;
  const Vector3d down = normal(*floor);
  for (const RoomPlane& wall : planes) {
    if (pairs.size() == kMostWalls) break;
    if (std::abs(normal(wall).dot(down)) > kUpright) continue;
    Triple t;
    t.normals << down, normal(wall), down.cross(normal(wall)).normalized();
    t.away_m = {1 / floor->inverse_per_m.norm(), 1 / wall.inverse_per_m.norm(), 0};
    pairs.push_back(t);
  }
  return pairs;
}

}  // namespace

std::vector<geometry::Pose> poses_along_walls(const std::vector<RoomPlane>& a,
                                              const std::vector<RoomPlane>& b, double step_m) {
  constexpr double kFarthest_m = 12;
  std::vector<geometry::Pose> poses;
  const std::vector<Triple> of_a = floors_and_walls(a), of_b = floors_and_walls(b);
  for (const Triple& ta : of_a)
    for (const Triple& tb : of_b) {
      const auto pose = pose_of(ta, tb);
      for (double s_m = -kFarthest_m; pose && s_m <= kFarthest_m; s_m += step_m) {
        poses.push_back(*pose);
        poses.back().translation_m += s_m * ta.normals.col(2);
      }
    }
  return poses;
}

std::vector<geometry::Pose> poses_from_planes(const std::vector<RoomPlane>& a,
                                              const std::vector<RoomPlane>& b) {
  std::vector<geometry::Pose> poses;
  const std::vector<Triple> of_a = triples_of(a, false), of_b = triples_of(b, true);
  for (const Triple& ta : of_a)
    for (const Triple& tb : of_b)
      if (const auto pose = pose_of(ta, tb)) poses.push_back(*pose);
  return poses;
}

}  // namespace mixrig::model

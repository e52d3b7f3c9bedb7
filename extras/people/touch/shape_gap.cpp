// SPDX-License-Identifier: Apache-2.0
#include "extras/people/touch/shape_gap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpa2.h>

namespace mixrig::touch {
namespace {

constexpr double kShapeSigma_m = 0.001;  ///< parts are convex hulls
constexpr double kRoomSigma_m = 0.02;    ///< the floor on which an object stands is not in it
constexpr float kRoomCell_m = 0.02F;
constexpr std::size_t kRoomCells = 5;

btTransform transform_of(const geometry::Pose& pose) {
  const Eigen::Quaternionf q = pose.rotation.cast<float>();
  const Eigen::Vector3f t = pose.translation_m.cast<float>();
  return btTransform(btQuaternion(q.x(), q.y(), q.z(), q.w()), btVector3(t.x(), t.y(), t.z()));
}

btConvexHullShape hull_of(const Convex& part) {
  btConvexHullShape hull(part.corners_m.data()->data(), static_cast<int>(part.corners_m.size()),
                         sizeof(Eigen::Vector3f));
  hull.setMargin(0);
  return hull;
}

Eigen::AlignedBox3d box_in_world(const Eigen::AlignedBox3f& box, const geometry::Pose& pose) {
  Eigen::AlignedBox3d out;
  for (int i = 0; i < 8; ++i)
    out.extend(pose * box.corner(static_cast<Eigen::AlignedBox3f::CornerType>(i)).cast<double>());
  return out;
}

/// The plane of `a` that `b`, in the axes of `a`, is least behind, by how much (negative: it is not
/// before any), and where.
struct Separation {
  float m = -std::numeric_limits<float>::max();
  Eigen::Vector3f at_m = Eigen::Vector3f::Zero();
};
Separation separation(const Convex& a, const Convex& b, const Eigen::Isometry3f& a_from_b) {
  constexpr float kLevel_m = 0.001F;
  Separation most;
  for (const Plane& plane : a.planes) {
    const Eigen::Vector3f normal = a_from_b.linear().transpose() * plane.normal;
    const float offset_m = plane.offset_m - plane.normal.dot(a_from_b.translation());
    float least = std::numeric_limits<float>::max();
    for (const auto& corner : b.corners_m) least = std::min(least, normal.dot(corner) - offset_m);
    if (least <= most.m) continue;
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    float count = 0;
    for (const auto& corner : b.corners_m)
      if (normal.dot(corner) - offset_m <= least + kLevel_m) sum += corner, ++count;
    most = {least, a_from_b * (sum / count)};
  }
  return most;
}

/// The least depth over the directions of all faces.
Gap overlap(const Convex& a, const geometry::Pose& world_from_a, const Convex& b,
            const geometry::Pose& world_from_b) {
  const Eigen::Isometry3f a_from_b(
      (geometry::inverse(world_from_a) * world_from_b).matrix().cast<float>());
  const Separation from_a = separation(a, b, a_from_b);
  const Separation from_b = separation(b, a, a_from_b.inverse());
  const bool by_a = from_a.m >= from_b.m;
  const Separation& most = by_a ? from_a : from_b;
  const geometry::Pose& pose = by_a ? world_from_a : world_from_b;
  return {std::min(0.0F, most.m), kShapeSigma_m, pose * most.at_m.cast<double>(), Evidence::kShape};
}

}  // namespace

std::optional<Gap> shape_gap(const Shape& a, const geometry::Pose& world_from_a, const Shape& b,
                             const geometry::Pose& world_from_b) {
  std::optional<Gap> nearest;
  const btTransform at_a = transform_of(world_from_a), at_b = transform_of(world_from_b);
  for (const Convex& part : a.parts) {
    const Eigen::AlignedBox3d box = box_in_world(part.box_m, world_from_a);
    std::optional<btConvexHullShape> hull;
    for (const Convex& other : b.parts) {
      if (box.exteriorDistance(box_in_world(other.box_m, world_from_b)) > double{kNear_m}) continue;
      if (!hull) hull.emplace(hull_of(part));
      const btConvexHullShape other_hull = hull_of(other);
      const btVector3 guess = at_a.getOrigin() - at_b.getOrigin();
      btGjkEpaSolver2::sResults found;
      Gap gap;
      if (btGjkEpaSolver2::Distance(&*hull, at_a, &other_hull, at_b, guess, found)) {
        const btVector3 at = 0.5F * (found.witnesses[0] + found.witnesses[1]);
        gap = {found.distance, kShapeSigma_m, {at.x(), at.y(), at.z()}, Evidence::kShape};
      } else {
        gap = overlap(part, world_from_a, other, world_from_b);
      }
      if (!nearest || gap.m < nearest->m) nearest = gap;
    }
  }
  return nearest;
}

std::optional<Gap> room_gap(const Shape& shape, const geometry::Pose& world_from_object,
                            std::span<const plan::RoomPoint> room) {
  const geometry::Pose object_from_world = geometry::inverse(world_from_object);
  std::map<std::array<long, 3>, std::pair<float, Eigen::Vector3f>> cells;
  for (const plan::RoomPoint& point : room) {
    const Eigen::Vector3f p = (object_from_world * point.at_m.cast<double>()).cast<float>();
    if (shape.box_m.squaredExteriorDistance(p) > kNear_m * kNear_m) continue;
    Eigen::Vector3f normal;
    const float d = shape.distance_m(p, normal);
    const Eigen::Vector3f cell = p / kRoomCell_m;
    const std::array<long, 3> key{std::lround(cell.x()), std::lround(cell.y()),
                                  std::lround(cell.z())};
    const auto at = cells.try_emplace(key, d, point.at_m).first;
    if (d < at->second.first) at->second = {d, point.at_m};
  }
  if (cells.size() < kRoomCells) return std::nullopt;
  std::vector<std::pair<float, Eigen::Vector3f>> nearest;
  for (const auto& [key, value] : cells) nearest.push_back(value);
  std::partial_sort(nearest.begin(), nearest.begin() + kRoomCells, nearest.end(),
                    [](const auto& x, const auto& y) { return x.first < y.first; });
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (std::size_t i = 0; i < kRoomCells; ++i) sum += nearest[i].second;
  return Gap{nearest[kRoomCells - 1].first, kRoomSigma_m,
             (sum / static_cast<float>(kRoomCells)).cast<double>(), Evidence::kSurface};
}

}  // namespace mixrig::touch

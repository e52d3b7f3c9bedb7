// SPDX-License-Identifier: Apache-2.0
#include "extras/map/reconstruction/maps/map_in_room.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "hal/base/order_statistics.h"
#include "host/math/estimation/decompositions.h"
#include "host/math/estimation/verdict.h"

namespace mixrig::reconstruction {
namespace {

using Eigen::Vector3d;
using Vector7 = Eigen::Matrix<double, 7, 1>;
using Matrix7 = Eigen::Matrix<double, 7, 7>;

constexpr std::size_t kFewestKeys = 3;
constexpr double kSameTurn_rad = 0.02, kSamePlace_m = 0.04;
constexpr double kRoomTukey = 4.685;
/// Standard deviation of a room's surface by interpolation, in addition to its stated one.
constexpr double kSurfaceSigma_m = 0.005;
/// Points of a part of the room: 8 azimuths, 4 elevations.
constexpr std::size_t kParts = 32;

double tukey_weight(double sigmas) {
  const double u = sigmas / kRoomTukey;
  return std::abs(u) < 1 ? (1 - u * u) * (1 - u * u) : 0;
}

Vector3d rotation_vector(const Eigen::Quaterniond& q) {
  const Eigen::AngleAxisd turn(q);
  const double angle = std::remainder(turn.angle(), 2 * std::numbers::pi);
  return angle * turn.axis();
}

/// A plane through the room's surface.
struct Facet {
  Vector3d place_m, normal;
  double sigma_m = 0;
  std::size_t part = 0;
};

/// Surface that the room's origin sees in the direction of a point; nullopt across steps and where
/// nothing is measured.
std::optional<Facet> facet_behind(const model::Panorama& room, const Vector3d& point_m) {
  constexpr int kReach = 2;
  const Size size = room.size();
  const double range = point_m.norm();
  if (!(range > 0)) return std::nullopt;
  const double azimuth = std::atan2(-point_m.x(), point_m.y());
  const double elevation = std::asin(std::clamp(point_m.z() / range, -1.0, 1.0));
  const int x = static_cast<int>((1 - azimuth / std::numbers::pi) * 0.5 * size.width) % size.width;
  const int y = static_cast<int>((0.5 - elevation / std::numbers::pi) * size.height);
  if (y < kReach || y + kReach >= size.height) return std::nullopt;
  const auto place = [&](int i, int j) -> Vector3d {
    const int column = (x + i + size.width) % size.width;
    return room.distance_m.at(column, y + j) * model::direction_of(size, column, y + j);
  };
  float low = 1e9F, high = 0;
  for (int j = -kReach; j <= kReach; j += kReach)
    for (int i = -kReach; i <= kReach; i += kReach) {
      const int column = (x + i + size.width) % size.width;
      if (room.views.at(column, y + j) == 0) return std::nullopt;
      const float d = room.distance_m.at(column, y + j);
      low = std::min(low, d), high = std::max(high, d);
    }
  if (!(low > 0) || model::is_depth_step(low, high)) return std::nullopt;
  const Vector3d across = place(kReach, 0) - place(-kReach, 0);
  const Vector3d normal = across.cross(place(0, kReach) - place(0, -kReach));
  if (!(normal.norm() > 0)) return std::nullopt;
  const auto sector = static_cast<std::size_t>(8 * x / size.width);
  const auto belt = static_cast<std::size_t>(4 * y / size.height);
  return Facet{place(0, 0), normal.normalized(), room.sigma_m.at(x, y), 4 * sector + belt};
}

/// Key pictures that `by` aligns with their poses in the room.
std::vector<std::size_t> agreeing(const LearnedMap& map, std::span<const KeyInRoom> found,
                                  const estimation::Similarity& by) {
  std::vector<std::size_t> those;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const geometry::Pose pose = carried(map.keys[found[i].key].map_from_camera, by);
    const geometry::Pose& seen = found[i].room_from_camera;
    if ((pose.translation_m - seen.translation_m).norm() < kSamePlace_m &&
        pose.rotation.angularDistance(seen.rotation) < kSameTurn_rad)
      those.push_back(i);
  }
  return those;
}

/// Similarity by two key pictures; nullopt where they are too near each other for a scale.
std::optional<estimation::Similarity> of_pair(const LearnedMap& map, const KeyInRoom& a,
                                              const KeyInRoom& b) {
  const geometry::Pose &from_a = map.keys[a.key].map_from_camera,
                       &from_b = map.keys[b.key].map_from_camera;
  estimation::Similarity by;
  if (!map.scale) {
    const double there_m =
        (a.room_from_camera.translation_m - b.room_from_camera.translation_m).norm();
    const double here = (from_a.translation_m - from_b.translation_m).norm();
    if (!(here > 0) || !(there_m > 0)) return std::nullopt;
    by.scale = there_m / here;
  }
  by.pose.rotation = (a.room_from_camera.rotation * from_a.rotation.conjugate()).normalized();
  by.pose.translation_m =
      a.room_from_camera.translation_m - by.scale * (by.pose.rotation * from_a.translation_m);
  return by;
}

class RoomFit {
 public:
  RoomFit(const LearnedMap& map, const model::Panorama& room, std::span<const KeyInRoom> found,
          const estimation::Similarity& start)
      : map_(map), room_(room), found_(found) {
    place_.room_from_map = start;
    for (const MapKey& key : map.keys)
      middle_ += key.map_from_camera.translation_m / static_cast<double>(map.keys.size());
  }
  MapInRoom run();

 private:
  void clear() {
    normal_.setZero(), gradient_.setZero(), of_cluster_.assign(kParts, Vector7::Zero());
  }
  void add(const Vector7& row, double residual, double weight, std::size_t cluster) {
    normal_ += weight * row * row.transpose();
    gradient_ -= weight * residual * row;
    of_cluster_[cluster] += weight * residual * row;
  }
  void add_keys();
  void add_points();
  void add_scale();
  double step();
  Vector3d middle_m() const { return place_.room_from_map * middle_; }

  const LearnedMap& map_;
  const model::Panorama& room_;
  const std::span<const KeyInRoom> found_;
  Vector3d middle_ = Vector3d::Zero();
  double spread_ = 1, prior_ = 0;  ///< of points over their sigmas; log(scale) of the start
  MapInRoom place_;
  Matrix7 normal_;
  Vector7 gradient_;
  std::vector<Vector7> of_cluster_;
};

/// Adds rows of the six coordinates of each key picture's pose, whitened.
void RoomFit::add_keys() {
  place_.keys_agree = 0;
  for (const KeyInRoom& k : found_) {
    const geometry::Pose pose = carried(map_.keys[k.key].map_from_camera, place_.room_from_map);
    Eigen::Matrix<double, 6, 1> residual;
    residual << rotation_vector(pose.rotation * k.room_from_camera.rotation.conjugate()),
        pose.translation_m - k.room_from_camera.translation_m;
    Eigen::Matrix<double, 6, 7> rows = Eigen::Matrix<double, 6, 7>::Zero();
    const Vector3d arm = pose.translation_m - middle_m();
    rows.block<3, 3>(0, 0).setIdentity(), rows.block<3, 3>(3, 3).setIdentity();
    rows.block<3, 3>(3, 0) << 0, arm.z(), -arm.y(), -arm.z(), 0, arm.x(), arm.y(), -arm.x(), 0;
    rows.block<3, 1>(3, 6) = arm;
    const Eigen::LLT<Eigen::Matrix<double, 6, 6>> root(k.covariance);
    if (root.info() != Eigen::Success) continue;
    root.matrixL().solveInPlace(residual), root.matrixL().solveInPlace(rows);
    if ((pose.translation_m - k.room_from_camera.translation_m).norm() > kSamePlace_m) continue;
    ++place_.keys_agree;
    of_cluster_.push_back(Vector7::Zero());
    for (int i = 0; i < 6; ++i)
      add(rows.row(i).transpose(), residual[i], 1, of_cluster_.size() - 1);
  }
}

/// Adds rows of the distances of points from the planes behind them.
void RoomFit::add_points() {
  struct Row {
    Vector7 row;
    double residual, sigma;
    std::size_t part;
  };
  std::vector<Row> rows;
  std::vector<double> sizes;
  const estimation::Similarity& by = place_.room_from_map;
  const Eigen::Matrix3d turn = by.scale * by.pose.rotation.toRotationMatrix();
  for (const MapPoint& p : map_.points) {
    const Vector3d at_m = by * p.place;
    const auto facet = facet_behind(room_, at_m);
    if (!facet) continue;
    const Vector3d in_map = turn.transpose() * facet->normal, arm = at_m - middle_m();
    const double variance = in_map.dot(p.covariance * in_map) + std::pow(facet->sigma_m, 2) +
                            std::pow(kSurfaceSigma_m, 2);
    Row row{Vector7::Zero(), facet->normal.dot(at_m - facet->place_m), std::sqrt(variance),
            facet->part};
    row.row << arm.cross(facet->normal), facet->normal, facet->normal.dot(arm);
    sizes.push_back(std::abs(row.residual) / row.sigma);
    rows.push_back(row);
  }
  place_.points = rows.size(), place_.points_agree = 0;
  if (rows.empty()) return;
  constexpr double kMedianOfNormal = 0.6745;
  spread_ = std::max(1.0, median_in_place(std::span<double>(sizes)) / kMedianOfNormal);
  for (const Row& r : rows) {
    const double sigma = spread_ * r.sigma;
    const double weight = tukey_weight(r.residual / sigma);
    constexpr double kOnSurface_m = 0.1;
    if (weight > 0 && std::abs(r.residual) < kOnSurface_m) ++place_.points_agree;
    add(r.row, r.residual, weight / (sigma * sigma), r.part);
  }
}

void RoomFit::add_scale() {
  if (!map_.scale || !(map_.scale->sigma > 0)) return;
  Vector7 row = Vector7::Zero();
  row[6] = 1;
  of_cluster_.push_back(Vector7::Zero());
  add(row, std::log(place_.room_from_map.scale), 1 / std::pow(map_.scale->sigma, 2),
      of_cluster_.size() - 1);
}

/// Makes one step; returns how far the middle of the map moved, m.
double RoomFit::step() {
  clear();
  add_keys(), add_points(), add_scale();
  const Vector7 d = normal_.ldlt().solve(gradient_);
  if (!d.allFinite()) return 0;
  const double angle = d.head<3>().norm();
  const Eigen::Quaterniond turn(
      Eigen::AngleAxisd(angle, angle > 0 ? Vector3d(d.head<3>() / angle) : Vector3d::UnitX()));
  estimation::Similarity& by = place_.room_from_map;
  const Vector3d moved_m = middle_m() + d.segment<3>(3);
  by.pose.rotation = (turn * by.pose.rotation).normalized();
  by.scale *= std::exp(d[6]);
  by.pose.translation_m = moved_m - by.scale * (by.pose.rotation * middle_);
  return d.segment<3>(3).norm() + angle + std::abs(d[6]);
}

MapInRoom RoomFit::run() {
  constexpr int kSteps = 30;
  constexpr double kStill = 1e-7;
  for (int i = 0; i < kSteps && step() > kStill; ++i) {
  }
  clear();
  add_keys(), add_points(), add_scale();
  Matrix7 common = Matrix7::Zero();
  for (const Vector7& g : of_cluster_) common += g * g.transpose();
  const Matrix7 inverse = normal_.ldlt().solve(Matrix7::Identity());
  // No smaller than if all errors were independent.
  place_.covariance = inverse + inverse * common * inverse;
  place_.keys = found_.size();
  return place_;
}

Error cannot(const std::string& why) {
  return {ErrorCode::kData, "the map cannot be placed in the room: " + why};
}

}  // namespace

double MapInRoom::sigma_m() const {
  return std::sqrt(estimation::spectrum_of(covariance.block<3, 3>(3, 3)).values[2]);
}
double MapInRoom::sigma_rad() const {
  return std::sqrt(estimation::spectrum_of(covariance.block<3, 3>(0, 0)).values[2]);
}
double MapInRoom::scale_sigma() const { return std::sqrt(covariance(6, 6)); }

Result<MapInRoom> place_in_room(const LearnedMap& map, const model::Panorama& room,
                                std::span<const KeyInRoom> found) {
  if (found.size() < kFewestKeys)
    return cannot(fmt::format("it explains {} of {} key pictures: is it the same room?",
                              found.size(), map.keys.size()));
  std::vector<std::size_t> best;
  estimation::Similarity start;
  for (const KeyInRoom& a : found)
    for (const KeyInRoom& b : found) {
      if (a.key == b.key && !map.scale) continue;
      const auto by = of_pair(map, a, b);
      if (!by) continue;
      auto those = agreeing(map, found, *by);
      if (those.size() > best.size()) best = std::move(those), start = *by;
      if (map.scale) break;  // one is enough
    }
  constexpr double kLeastAgree = 0.6;
  if (best.size() < kFewestKeys ||
      static_cast<double>(best.size()) < kLeastAgree * static_cast<double>(found.size()))
    return cannot(
        fmt::format("only {} of {} key pictures agree on one place: is it the same room, "
                    "and does no part of it repeat?",
                    best.size(), found.size()));
  std::vector<KeyInRoom> agree;
  for (const std::size_t i : best) agree.push_back(found[i]);
  MapInRoom place = RoomFit(map, room, agree, start).run();
  place.keys = found.size();
  if (2 * place.points_agree < place.points || place.points == 0)
    return cannot(
        fmt::format("only {} of {} of its points lie on the surface of the room: has the "
                    "room changed?",
                    place.points_agree, place.points));
  constexpr double kMostScaleSigma = 0.05, kPercent = 100;
  if (!(place.scale_sigma() < kMostScaleSigma))
    return cannot(fmt::format("its scale is known to {:.0f} % only: learn it from a longer path",
                              kPercent * place.scale_sigma()));
  return place;
}

LearnedMap in_room(const LearnedMap& map, const MapInRoom& place) {
  LearnedMap out = carried(map, place.room_from_map);
  out.scale = MapScale{place.scale_sigma(), static_cast<int>(place.points_agree)};
  out.room = RoomAxes{place.sigma_m(), place.sigma_rad(), {}};
  return out;
}

}  // namespace mixrig::reconstruction

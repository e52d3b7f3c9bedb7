// SPDX-License-Identifier: Apache-2.0
// The covariance of a map's place is the sum of that of independent errors and that of errors which
// key pictures and parts of the room share: it is modest by half where errors are independent.
#include "extras/map/reconstruction/maps/map_in_room.h"
#include "tests/stability/random_geometry.h"
#include "tests/stability/suite.h"
#include "tests/support/textured_box.h"

namespace mixrig::estimation_bench {
namespace {

using Eigen::Vector3d;

/// Parameters of a case; the defaults are 300 places on the walls of a box, off by 4 mm, and eight
/// key pictures, off by 1 mm and 0.5 mrad; the map's unit is 4 m.
struct MapScene {
  double scale = 4;     ///< metres per unit of the map
  bool metric = false;  ///< the map states its scale
  int points = 300, keys = 8;
  int wrong_keys = 0;           ///< found half a metre away
  double spread = 1;            ///< factor of the path of the key pictures
  double wall = 1;              ///< factor on the distances of the places: another room
  double common_m = 0;          ///< sigma of an error that all places on one side share
  Vector3d origin = {0, 0, 0};  ///< of the map's axes, units of the map
  bool nan = false;
};

constexpr double kMapPlace_m = 0.004, kMapPose_m = 0.001, kMapPose_rad = 0.0005;

struct Placed {
  reconstruction::LearnedMap map;
  std::vector<reconstruction::KeyInRoom> found;
};

Placed placed_in_box(const MapScene& scene, const geometry::Pose& room_from_map,
                     RandomGeometry& random) {
  const auto in_map = [&](const Vector3d& room_m) -> Vector3d {
    return (geometry::inverse(room_from_map) * room_m) / scene.scale + scene.origin;
  };
  Placed placed;
  if (scene.metric) placed.map.scale = reconstruction::MapScale{0.002, 100};
  const Vector3d eye(0.1, 0.05, 0);
  const Vector3d shared = random.normal3(scene.common_m);
  for (int i = 0; i < scene.points; ++i) {
    const Vector3d ray = random.normal3().normalized();
    const Vector3d at = eye + scene.wall * test::TexturedBox::distance_m(eye, ray) * ray;
    reconstruction::MapPoint point;
    point.place = in_map(at + random.normal3(kMapPlace_m) + (ray.x() > 0 ? shared : -shared));
    point.covariance = std::pow(kMapPlace_m / scene.scale, 2) * Eigen::Matrix3d::Identity();
    if (scene.nan && i == 0) point.place.x() = NAN;
    placed.map.points.push_back(point);
  }
  for (int i = 0; i < scene.keys; ++i) {
    const Vector3d at = scene.spread * Vector3d(0.1 * i, 0.2 * std::sin(i), 0.05 * (i % 3));
    const geometry::Pose pose{estimation::rotation_exp(random.in_box(0.5)), at};
    reconstruction::MapKey key;
    key.map_from_camera = geometry::inverse(room_from_map) * pose;
    key.map_from_camera.translation_m = in_map(at);
    placed.map.keys.push_back(key);
    reconstruction::KeyInRoom found;
    found.key = static_cast<std::size_t>(i);
    found.room_from_camera = {
        estimation::rotation_exp(random.normal3(kMapPose_rad)) * pose.rotation,
        at + random.normal3(kMapPose_m)};
    if (i < scene.wrong_keys) found.room_from_camera.translation_m += random.in_box(0.5);
    found.covariance.diagonal() << Vector3d::Constant(kMapPose_rad * kMapPose_rad),
        Vector3d::Constant(kMapPose_m * kMapPose_m);
    placed.found.push_back(found);
  }
  return placed;
}

const model::Panorama& box_room() {
  static const model::Panorama room = test::TexturedBox().panorama();
  return room;
}

/// Error at the middle of the key pictures: rotation vector, translation, log of the scale.
Eigen::VectorXd error_of(const reconstruction::MapInRoom& place, const Placed& placed,
                         const MapScene& scene, const geometry::Pose& room_from_map) {
  Vector3d middle = Vector3d::Zero();
  for (const auto& key : placed.map.keys)
    middle += key.map_from_camera.translation_m / static_cast<double>(placed.map.keys.size());
  const Vector3d is = room_from_map * Vector3d(scene.scale * (middle - scene.origin));
  const Eigen::AngleAxisd turn(room_from_map.rotation *
                               place.room_from_map.pose.rotation.conjugate());
  Eigen::VectorXd error(7);
  error << -turn.angle() * turn.axis(), place.room_from_map * middle - is,
      std::log(place.room_from_map.scale / scene.scale);
  return error;
}

Trial run(const MapScene& scene, std::uint64_t seed, Residuals&) {
  RandomGeometry random(seed);
  const geometry::Pose room_from_map{random.rotation(), random.in_box(0.5)};
  const Placed placed = placed_in_box(scene, room_from_map, random);
  estimation::Estimate<reconstruction::MapInRoom> estimate;
  const auto find = [&] {
    const auto place = reconstruction::place_in_room(placed.map, box_room(), placed.found);
    estimation::Estimate<reconstruction::MapInRoom> of;
    of.verdict =
        place ? estimation::Verdict::ok() : estimation::Verdict::degenerate(place.error().context);
    if (place) of.value = *place, of.covariance = place->covariance;
    return of;
  };
  Trial trial = timed(find, estimate);
  if (estimate.usable()) trial.error = error_of(estimate.value, placed, scene, room_from_map);
  return trial;
}

}  // namespace

void add_map_place_cases(std::vector<Case>& cases) {
  const auto add = case_adder<MapScene>(cases, "place_in_room", run);
  add("a map without a scale", Expect::kRobust, {});
  add("a metric map", Expect::kRobust, {.scale = 1, .metric = true});
  add("unit 1 mm", Expect::kRobust, {.scale = 1e-3});
  add("unit 1 km", Expect::kRobust, {.scale = 1e3});
  add("three key pictures", Expect::kRobust, {.keys = 3});
  add("1 km from the map's origin", Expect::kRobust,
      {.scale = 1, .metric = true, .origin = {1e3, -1e3, 1e3}});
  add("an error that a side shares", Expect::kRobust, {.common_m = 0.004});
  add("two key pictures of eight elsewhere", Expect::kRobust, {.wrong_keys = 2});
  add("another room", Expect::kRefusal, {.wall = 1.4});
  add("five key pictures of eight elsewhere", Expect::kRefusal, {.wrong_keys = 5});
  add("two key pictures", Expect::kRefusal, {.keys = 2});
  add("no place", Expect::kRefusal, {.points = 0});
  add("key pictures at one spot", Expect::kRefusal, {.spread = 0});
  for (const double path : {0.3, 0.1, 0.03, 0.01})
    add("path " + shown(path), Expect::kCareful, {.spread = path / 0.7},
        "path of the key pictures, m", path);
}

}  // namespace mixrig::estimation_bench

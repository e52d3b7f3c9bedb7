// SPDX-License-Identifier: Apache-2.0
#include "host/room/lamps/lamp_tracks.h"
#include "tests/stability/random_geometry.h"
#include "tests/stability/suite.h"

namespace mixrig::estimation_bench {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Parameters of a case; the defaults are nine fisheye views on a path of 1 m of a bulb 3 m away,
/// whose direction has the sigma that find_lamps assumes at least.
struct BulbScene {
  int views = 9;
  double path_m = 1;
  double depth_m = 3;
  Vector3d origin_m = {0, 0, 0};
  double common_rad = 0;  ///< sigma of the lens's error that all views share
  int moved = 0;          ///< views that see something else, 4 degrees off
  bool moves = false;     ///< each view sees another place: a highlight
  bool nan = false;
};

constexpr double kBulb_rad = 3e-4, kBulbRadius_rad = 4e-3;

/// A round region of even solid angle about a direction.
lights::BrightRegion region_at(const Vector3d& direction) {
  lights::BrightRegion region;
  region.direction = direction.normalized();
  region.covariance.setZero();
  region.solid_angle_sr = M_PI * kBulbRadius_rad * kBulbRadius_rad;
  region.pixels = 40;
  const Vector3d u = region.direction.unitOrthogonal(), v = region.direction.cross(u);
  constexpr int kRays = 40;
  for (int i = 0; i < kRays; ++i) {
    const double radius = kBulbRadius_rad * std::sqrt((i + 0.5) / kRays), turn = 2.4 * i;
    const Vector3d side = radius * (std::cos(turn) * u + std::sin(turn) * v);
    region.rays.push_back({(region.direction + side).normalized(), region.solid_angle_sr / kRays});
  }
  return region;
}

/// Directions in 50 digits: the angle across and that down, for small errors.
Residuals direction_model(const std::vector<lights::LampView>& views, const Vector3d& truth) {
  return [views, truth](const Reals& x) {
    Reals r;
    const Reals p = {Real(truth.x()) + x[0], Real(truth.y()) + x[1], Real(truth.z()) + x[2]};
    for (const lights::LampView& view : views) {
      const Vector3d ray = view.regions[0].direction, u = ray.unitOrthogonal(), v = ray.cross(u);
      const Reals q = mapped_back(moved(view.world_from_camera, Reals(6, Real(0))), p);
      const Real range = length(q);
      for (const Vector3d& side : {u, v}) {
        Real off = 0;
        for (int k = 0; k < 3; ++k) off += Real(side[k]) * q[k];
        r.push_back(off / range / Real(kBulb_rad));
      }
    }
    return r;
  };
}

Trial run(const BulbScene& scene, std::uint64_t seed, Residuals& residuals) {
  RandomGeometry random(seed);
  const Vector3d truth = scene.origin_m + Vector3d(0.3, scene.depth_m, 1.7);
  const Vector2d common = scene.common_rad * Vector2d(random.normal(), random.normal());
  std::vector<lights::LampView> views;
  for (int i = 0; i < scene.views; ++i) {
    const double along = scene.views > 1 ? static_cast<double>(i) / (scene.views - 1) - 0.5 : 0;
    // Heights below and above the bulb: it is on no ceiling.
    const Vector3d eye = scene.origin_m + Vector3d(scene.path_m * along, 0, 1.7) +
                         Vector3d(0, 0, (i % 2 == 0 ? 0.02 : -0.02) * scene.path_m);
    const geometry::Pose pose{estimation::rotation_exp(random.in_box(0.1)), eye};
    Vector3d at = truth;
    if (scene.moves) at += random.in_box(0.15);
    if (i < scene.moved) at += 0.07 * scene.depth_m * Vector3d::UnitX();
    const Vector3d seen = geometry::inverse(pose) * at;
    const Vector3d ray = seen.normalized(), u = ray.unitOrthogonal(), v = ray.cross(u);
    const Vector2d off = kBulb_rad * Vector2d(random.normal(), random.normal()) + common;
    auto region = region_at(ray + off.x() * u + off.y() * v);
    if (scene.nan && i == 0) region.direction.x() = NAN;
    views.push_back({pose, {region}});
  }
  estimation::Estimate<Vector3d> estimate;
  std::string why = "nothing was found";
  const auto find = [&] {
    const auto search = lights::find_lamps(views, nullptr, {.common_rad = scene.common_rad});
    estimation::Estimate<Vector3d> found;
    if (!search.rejected.empty()) why = lights::text_of(search.rejected.front().refusal);
    found.verdict = estimation::Verdict::degenerate(why);
    if (search.lamps.size() != 1) return found;
    found.value = search.lamps[0].position_m, found.covariance = search.lamps[0].covariance;
    found.verdict = estimation::Verdict::ok();
    return found;
  };
  Trial trial = timed(find, estimate);
  if (!estimate.usable()) return trial;
  trial.error = estimate.value - truth;
  if (scene.moved == 0 && scene.common_rad == 0) residuals = direction_model(views, truth);
  return trial;
}

}  // namespace

void add_lamp_cases(std::vector<Case>& cases) {
  const auto add = case_adder<BulbScene>(cases, "find_lamps", run);
  add("nine views", Expect::kAnswer, {});
  add("three views", Expect::kAnswer, {.views = 3});
  add("60 views", Expect::kAnswer, {.views = 60});
  add("path 1:10", Expect::kAnswer, {.path_m = 0.3});
  add("1 km from the origin", Expect::kAnswer, {.origin_m = {1e3, -1e3, 1e3}});
  add("1e6 m from the origin", Expect::kAnswer, {.origin_m = {1e6, -1e6, 1e6}});
  add("an error of the lens in all views", Expect::kRobust, {.common_rad = 5e-4});
  add("one view of nine is not a number", Expect::kRobust, {.nan = true});
  add("path 1:100", Expect::kCareful, {.path_m = 0.03});
  add("one view of nine sees another thing", Expect::kCareful, {.moved = 1});
  add("a highlight", Expect::kRefusal, {.moves = true});
  add("path 1:3000", Expect::kRefusal, {.path_m = 0.001});
  add("no path", Expect::kRefusal, {.path_m = 0});
  add("one view", Expect::kRefusal, {.views = 1});
  add("no view", Expect::kRefusal, {.views = 0});
  for (const double path : {0.3, 0.1, 0.03, 0.01, 0.003, 0.001})
    add("path " + shown(path), Expect::kCareful, {.path_m = 3 * path}, "path over distance", path);
}

}  // namespace mixrig::estimation_bench

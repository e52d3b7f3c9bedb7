// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/pose/pnp.h"
#include "tests/stability/random_geometry.h"
#include "tests/stability/suite.h"

namespace mixrig::estimation_bench {
namespace {

using Eigen::Vector3d;
using estimation::Bearing;
using Points = std::vector<Vector3d>;

/// Parameters of a case; the defaults are fifteen points in a cube of 2 m at 5 m, f = 600 px, 0.5
/// px noise.
struct PnpScene {
  Vector3d stretch = {1, 1, 1};
  int points = 15;
  double depth = 5;
  Vector3d turn_rad = {0.3, -0.5, 0.2};
  double scale = 1;
  Vector3d origin = {0, 0, 0};
  bool all_around = false;  ///< points on all sides, seen by an equidistant fisheye
  int outliers = 0;
  bool nan = false;
  bool flipped = false;  ///< directions opposite to the points
};

constexpr double kPnpSigma_px = 0.5, kPnpFocal_px = 600;

/// Pixels of a pinhole, or the two angles across a direction for the fisheye, in 50 digits.
Residuals pixel_model(const Points& points, const std::vector<Vector3d>& rays,
                      const geometry::Pose& truth, bool fisheye) {
  return [=](const Reals& x) {
    const Motion m = moved_about(truth, points[0], x);
    Reals r;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Reals q = mapped(m, reals(points[i]));
      const Vector3d& d = rays[i];
      if (!fisheye) {
        for (int k = 0; k < 2; ++k)
          r.push_back(Real(kPnpFocal_px) * (q[k] / q[2] - Real(d[k]) / Real(d.z())) /
                      Real(kPnpSigma_px));
        continue;
      }
      const Vector3d u = d.unitOrthogonal(), v = d.cross(u);
      const Real n = length(q) * Real(kPnpSigma_px) / Real(kPnpFocal_px);
      r.push_back((q[0] * u.x() + q[1] * u.y() + q[2] * u.z()) / n);
      r.push_back((q[0] * v.x() + q[1] * v.y() + q[2] * v.z()) / n);
    }
    return r;
  };
}

Trial run(const PnpScene& scene, std::uint64_t seed, Residuals& residuals) {
  RandomGeometry random(seed);
  Points points = random.cloud(scene.points, 1.0);
  geometry::Pose truth{estimation::rotation_exp(scene.turn_rad), {}};
  for (Vector3d& p : points) p = scene.origin + scene.scale * p.cwiseProduct(scene.stretch);
  truth.translation_m = scene.scale * Vector3d(0.1, -0.2, scene.all_around ? 0.1 : scene.depth) -
                        truth.rotation * scene.origin;
  const geometry::CameraModel camera{{{640, 480}, kPnpFocal_px, kPnpFocal_px, 0, 0}, {}};
  std::vector<Bearing> bearings;
  std::vector<Vector3d> rays;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector3d seen = truth * points[i];
    Bearing bearing;
    if (scene.all_around || static_cast<int>(i) < scene.outliers) {
      const bool wrong = static_cast<int>(i) < scene.outliers;
      const double sigma = kPnpSigma_px / kPnpFocal_px;
      const Vector3d d = wrong ? random.in_box(1) + Vector3d(0, 0, 2) : seen.normalized();
      bearing = estimation::bearing_of(d + random.normal3(sigma), sigma);
    } else {
      const Eigen::Vector2d px = camera.pinhole.project(seen) +
                                 kPnpSigma_px * Eigen::Vector2d(random.normal(), random.normal());
      bearing = *estimation::bearing_of(camera, px, kPnpSigma_px);
    }
    if (scene.nan && i == 1) bearing.direction.x() = NAN;
    if (scene.flipped) bearing.direction = -bearing.direction;
    bearings.push_back(bearing);
    rays.push_back(bearing.direction);
  }
  estimation::Estimate<geometry::Pose> estimate;
  Trial trial = timed([&] { return estimation::solve_pnp(points, bearings); }, estimate);
  if (!estimate.usable()) return trial;
  const PoseChart chart{points[0], estimate.value.rotation * points[0]};
  trial.error = chart.error(estimation::pose_error(estimate.value, truth),
                            estimate.value * points[0], truth * points[0]);
  trial.covariance = chart.covariance(trial.covariance);
  if (scene.outliers == 0) residuals = pixel_model(points, rays, truth, scene.all_around);
  return trial;
}

}  // namespace

void add_pnp_cases(std::vector<Case>& cases) {
  const auto add = case_adder<PnpScene>(cases, "solve_pnp", run);
  add("cube", Expect::kAnswer, {});
  add("plane", Expect::kAnswer, {.stretch = {1, 1, 0}});
  add("six points", Expect::kAnswer, {.points = 6, .depth = 3});
  add("half turn about x", Expect::kAnswer, {.turn_rad = {M_PI, 0, 0}});
  add("half turn about a diagonal", Expect::kAnswer,
      {.turn_rad = M_PI * Vector3d(1, 1, 1).normalized()});
  add("gimbal lock, pitch 90 deg", Expect::kAnswer, {.turn_rad = {0, M_PI / 2, 0}});
  add("fisheye, points all around", Expect::kAnswer, {.all_around = true});
  add("scale 1e-3", Expect::kAnswer, {.scale = 1e-3});
  add("scale 1e3", Expect::kAnswer, {.scale = 1e3});
  add("1e6 m from the origin", Expect::kAnswer, {.origin = {1e6, -1e6, 1e6}});
  add("at 20 spreads", Expect::kAnswer, {.depth = 20});
  add("one outlier of fifteen", Expect::kRobust, {.outliers = 1});
  add("six outliers of fifteen", Expect::kCareful, {.outliers = 6});
  add("four points", Expect::kCareful, {.points = 4});
  add("line 1:20", Expect::kCareful, {.stretch = {1, 0.05, 0.05}});
  add("plane at 40 spreads", Expect::kCareful, {.stretch = {1, 1, 0}, .depth = 40});
  add("line 1:1000", Expect::kRefusal, {.stretch = {1, 0.001, 0.001}});
  add("collinear", Expect::kRefusal, {.stretch = {1, 0, 0}});
  add("coinciding", Expect::kRefusal, {.stretch = {0, 0, 0}});
  add("all outliers", Expect::kRefusal, {.outliers = 15});
  add("points behind the camera", Expect::kRefusal, {.flipped = true});
  add("not a number", Expect::kRefusal, {.nan = true});
  add("three points", Expect::kRefusal, {.points = 3});
  for (const double size : {0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005})
    add("plane " + shown(size), Expect::kCareful, {.stretch = {1, 1, 0}, .depth = 1 / size},
        "size of a plane over its distance", size);
}

}  // namespace mixrig::estimation_bench

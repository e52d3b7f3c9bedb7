// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/points/triangulation.h"
#include "tests/stability/random_geometry.h"
#include "tests/stability/suite.h"

namespace mixrig::estimation_bench {
namespace {

using Eigen::Vector3d;
using estimation::PointView;

/// Parameters of a case; the defaults are four pinhole views, 1 m apart, of a point 4 m away, 0.5
/// px noise.
struct RayScene {
  int views = 4;
  double baseline = 1;
  Vector3d direction = {1, 0, 0};  ///< direction of the baseline; z is towards the point
  double depth = 4;
  double scale = 1;
  Vector3d origin = {0, 0, 0};
  int outliers = 0;
  bool nan = false;
  bool behind = false;
};

constexpr double kRaySigma_px = 0.5, kRayFocal_px = 600;

/// Pinhole pixels of the point in 50 digits: the reference does not use bearings.
Residuals pixel_model(const std::vector<geometry::Pose>& cameras,
                      const std::vector<Eigen::Vector2d>& pixels, const Vector3d& truth) {
  return [=](const Reals& x) {
    Reals r;
    const Reals p = {Real(truth.x()) + x[0], Real(truth.y()) + x[1], Real(truth.z()) + x[2]};
    for (std::size_t i = 0; i < cameras.size(); ++i) {
      const Reals q = mapped_back(moved(cameras[i], Reals(6, Real(0))), p);
      for (int k = 0; k < 2; ++k)
        r.push_back((Real(kRayFocal_px) * q[k] / q[2] - Real(pixels[i][k])) / Real(kRaySigma_px));
    }
    return r;
  };
}

Trial run(const RayScene& scene, std::uint64_t seed, Residuals& residuals) {
  RandomGeometry random(seed);
  const Vector3d truth = scene.origin + scene.scale * Vector3d(0.1, 0.2, scene.depth);
  const geometry::CameraModel camera{{{640, 480}, kRayFocal_px, kRayFocal_px, 0, 0}, {}};
  std::vector<geometry::Pose> cameras;
  std::vector<Eigen::Vector2d> pixels;
  std::vector<PointView> views;
  for (int i = 0; i < scene.views; ++i) {
    const Vector3d side = scene.baseline * scene.direction * (i - 0.5 * (scene.views - 1)) +
                          0.02 * scene.baseline * random.in_box(1);
    geometry::Pose pose{estimation::rotation_exp(random.in_box(0.1)),
                        scene.origin + scene.scale * side};
    const Vector3d seen = geometry::inverse(pose) * truth;
    Eigen::Vector2d px = camera.pinhole.project(seen) +
                         kRaySigma_px * Eigen::Vector2d(random.normal(), random.normal());
    if (i < scene.outliers) px += Eigen::Vector2d(random.uniform(40, 90), random.uniform(40, 90));
    if (scene.outliers == scene.views) px = {random.uniform(-300, 300), random.uniform(-200, 200)};
    auto bearing = *estimation::bearing_of(camera, px, kRaySigma_px);
    if (scene.behind) bearing.direction = -bearing.direction;
    if (scene.nan && i == 0) bearing.direction.y() = NAN;
    cameras.push_back(pose);
    pixels.push_back(px);
    views.push_back({pose, bearing});
  }
  estimation::Estimate<Vector3d> estimate;
  Trial trial = timed([&] { return estimation::triangulate(views); }, estimate);
  if (!estimate.usable()) return trial;
  trial.error = estimate.value - truth;
  if (scene.outliers == 0) residuals = pixel_model(cameras, pixels, truth);
  return trial;
}

}  // namespace

void add_triangulation_cases(std::vector<Case>& cases) {
  const auto add = case_adder<RayScene>(cases, "triangulate", run);
  add("four views", Expect::kAnswer, {});
  add("two views", Expect::kAnswer, {.views = 2});
  add("parallax 1:10", Expect::kAnswer, {.views = 2, .baseline = 0.4});
  add("parallax 1:40", Expect::kAnswer, {.views = 2, .baseline = 0.1});
  add("near the epipole", Expect::kAnswer, {.direction = {0.2, 0, 1}});
  add("scale 1e-3", Expect::kAnswer, {.scale = 1e-3});
  add("scale 1e3", Expect::kAnswer, {.scale = 1e3});
  add("1e6 m from the origin", Expect::kAnswer, {.origin = {1e6, -1e6, 1e6}});
  add("one outlier of eight", Expect::kRobust, {.views = 8, .baseline = 0.5, .outliers = 1});
  add("parallax 1:200", Expect::kCareful, {.views = 2, .baseline = 0.02});
  add("on the epipole", Expect::kCareful, {.views = 2, .direction = {0.01, 0, 1}});
  add("parallax 1:4000", Expect::kRefusal, {.views = 2, .baseline = 0.001});
  add("no baseline", Expect::kRefusal, {.baseline = 0});
  add("one view", Expect::kRefusal, {.views = 1});
  add("all outliers", Expect::kRefusal, {.views = 6, .outliers = 6});
  add("behind the cameras", Expect::kRefusal, {.behind = true});
  add("not a number", Expect::kRefusal, {.nan = true});
  for (const double parallax : {0.5, 0.1, 0.03, 0.01, 0.005, 0.002, 0.0005})
    add("parallax " + shown(parallax), Expect::kCareful, {.views = 2, .baseline = 4 * parallax},
        "baseline over distance, two views", parallax);
}

}  // namespace mixrig::estimation_bench

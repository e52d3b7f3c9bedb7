// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/points/plane_fit.h"
#include "tests/stability/random_geometry.h"
#include "tests/stability/suite.h"

namespace mixrig::estimation_bench {
namespace {

using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

/// Parameters of a case; the defaults are forty points on a square of 2 m under 1 mm noise along
/// the normal.
struct PlaneScene {
  double width = 1;  ///< factor of the second axis
  double scale = 1;
  Vector3d origin = {0, 0, 0};
  int points = 40;
  int outliers = 0;
  bool nan = false;
};

constexpr double kPlaneSigma_m = 1e-3;

Trial run(const PlaneScene& scene, std::uint64_t seed, Residuals& residuals) {
  RandomGeometry random(seed);
  const Eigen::Matrix3d axes = random.rotation().toRotationMatrix();
  const double sigma = kPlaneSigma_m * scene.scale;
  Points flat, points;
  for (int i = 0; i < scene.points; ++i) {
    const Vector3d at(random.uniform(-1, 1), scene.width * random.uniform(-1, 1),
                      i < scene.outliers ? random.uniform(-1, 1) : 0);
    flat.push_back(scene.scale * at);
    points.push_back(scene.origin + axes * (flat.back() + Vector3d(0, 0, sigma * random.normal())));
  }
  if (scene.nan) points[3].x() = NAN;
  estimation::Estimate<estimation::PlaneFit> estimate;
  Trial trial = timed([&] { return estimation::fit_plane_robust(points, sigma); }, estimate);
  if (!estimate.usable()) return trial;
  // Error parameters: tilts of the normal towards the estimate's tangents, and the offset at its
  // centroid.
  const auto& fit = estimate.value;
  const Vector3d truth = axes.col(2) * (axes.col(2).dot(fit.plane.normal) > 0 ? 1 : -1);
  trial.error = Vector3d(-truth.dot(fit.tangents.col(0)), -truth.dot(fit.tangents.col(1)),
                         -truth.dot(fit.centroid_m - scene.origin));
  if (scene.outliers > 0) return trial;
  // In the estimate's own tangent frame: height over the true plane = offset + tilt . position.
  residuals = [points, fit, truth, sigma, origin = scene.origin](const Reals& x) {
    // The normal is truth + x0 tangent0 + x1 tangent1, whose length is not quite 1.
    Reals normal = reals(truth);
    for (int k = 0; k < 3; ++k)
      normal[k] += x[0] * Real(fit.tangents(k, 0)) + x[1] * Real(fit.tangents(k, 1));
    const Real norm = length(normal);
    Reals r;
    for (const Vector3d& p : points) {
      const Vector3d arm = p - fit.centroid_m;
      const Real height = Real(truth.dot(p - origin));
      const Real slope =
          x[0] * Real(fit.tangents.col(0).dot(arm)) + x[1] * Real(fit.tangents.col(1).dot(arm));
      r.push_back((height + slope + x[2]) / norm / Real(sigma));
    }
    return r;
  };
  return trial;
}

}  // namespace

void add_plane_fit_cases(std::vector<Case>& cases) {
  const auto add = case_adder<PlaneScene>(cases, "fit_plane_robust", run);
  add("square", Expect::kAnswer, {});
  add("strip 1:10", Expect::kAnswer, {.width = 0.1});
  add("strip 1:50", Expect::kAnswer, {.width = 0.02});
  add("scale 1e-3", Expect::kAnswer, {.scale = 1e-3});
  add("scale 1e3", Expect::kAnswer, {.scale = 1e3});
  add("1e6 m from the origin", Expect::kAnswer, {.origin = {1e6, -1e6, 1e6}});
  add("one outlier of forty", Expect::kRobust, {.outliers = 1});
  add("fifteen outliers of forty", Expect::kCareful, {.outliers = 15});
  add("strip 1:200", Expect::kCareful, {.width = 0.005});
  add("strip 1:2000", Expect::kRefusal, {.width = 0.0005});
  add("collinear", Expect::kRefusal, {.width = 0});
  add("all outliers", Expect::kRefusal, {.outliers = 40});
  add("not a number", Expect::kRefusal, {.nan = true});
  add("two points", Expect::kRefusal, {.points = 2, .nan = false});
  for (const double width : {1.0, 0.3, 0.1, 0.03, 0.01, 0.003, 0.001})
    add("width " + shown(width), Expect::kCareful, {.width = width},
        "width of the strip over its length", width);
}

}  // namespace mixrig::estimation_bench

// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "host/estimation/rigid_fit.h"
#include "tests/stability/harness.h"
#include "tests/support/random_geometry.h"

namespace mixrig::stability {
namespace {

using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

/// How a case differs from ten points in a cube of 2 m under 1 mm of noise.
struct Scene {
  Vector3d stretch = {1, 1, 1};  ///< of the cloud
  double scale = 1;              ///< of cloud and noise
  Vector3d origin = {0, 0, 0};   ///< of the cloud
  std::optional<Vector3d> turn_rad = std::nullopt;
  int points = 10;
  int outliers = 0;
  bool doubled = false;
  bool nan = false;
  bool mirrored = false;
};

constexpr double kSigma_m = 1e-3;

Trial run(const Scene& scene, std::uint64_t seed, Residuals& residuals) {
  test::RandomGeometry random(seed);
  Points a = random.cloud(scene.points, 1.0), b;
  geometry::Pose truth = random.pose(2 * scene.scale);
  if (scene.turn_rad) truth.rotation = estimation::rotation_exp(*scene.turn_rad);
  const double sigma = kSigma_m * scene.scale;
  for (Vector3d& p : a) p = scene.origin + scene.scale * p.cwiseProduct(scene.stretch);
  if (scene.doubled) a.insert(a.end(), a.begin(), a.begin() + scene.points);
  for (const Vector3d& p : a) b.push_back(truth * p + random.normal3(sigma));
  for (int i = 0; i < scene.outliers; ++i) b[i] = random.in_box(3);
  if (scene.nan) b[1].y() = NAN;
  if (scene.mirrored)
    for (Vector3d& p : b) p.x() = -p.x();
  estimation::Estimate<geometry::Pose> estimate;
  Trial trial = timed([&] { return estimation::rigid_fit(a, b, {sigma, {}}); }, estimate);
  if (!estimate.usable()) return trial;
  trial.error = estimation::pose_error(estimate.value, truth);
  if (scene.outliers > 0) return trial;
  residuals = [a, b, truth, sigma](const Reals& x) {
    const Motion m = moved(truth, x);
    Reals r;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const Reals p = mapped(m, reals(a[i]));
      for (int k = 0; k < 3; ++k) r.push_back((p[k] - Real(b[i][k])) / Real(sigma));
    }
    return r;
  };
  return trial;
}

void check_scene(const std::string& name, Expect expect, const Scene& scene) {
  check({"rigid_fit", name, expect, [scene](std::uint64_t seed, Residuals& residuals) {
           return run(scene, seed, residuals);
         }});
}

TEST(RigidFitStability, WellPosed) {
  check_scene("cube", Expect::kAnswer, {});
  check_scene("coplanar", Expect::kAnswer, {.stretch = {1, 1, 0}});
  check_scene("three points", Expect::kAnswer, {.points = 3});
  check_scene("half turn about x", Expect::kAnswer, {.turn_rad = Vector3d(M_PI, 0, 0)});
  check_scene("half turn about a diagonal", Expect::kAnswer,
              {.turn_rad = M_PI * Vector3d(1, 1, 1).normalized()});
  check_scene("gimbal lock, pitch 90 deg", Expect::kAnswer, {.turn_rad = Vector3d(0, M_PI / 2, 0)});
  check_scene("scale 1e-3", Expect::kAnswer, {.scale = 1e-3});
  check_scene("scale 1e3", Expect::kAnswer, {.scale = 1e3});
  check_scene("1e6 m from the origin", Expect::kAnswer, {.origin = {1e6, -1e6, 1e6}});
  check_scene("every point twice", Expect::kAnswer, {.doubled = true});
  check_scene("flattened to a line 1:10", Expect::kAnswer, {.stretch = {1, 0.1, 0.1}});
  check_scene("flattened to a line 1:100", Expect::kAnswer, {.stretch = {1, 0.02, 0.02}});
}

TEST(RigidFitStability, OutliersAndDegenerate) {
  check_scene("one outlier of ten", Expect::kCareful, {.outliers = 1});
  check_scene("four outliers of ten", Expect::kCareful, {.outliers = 4});
  check_scene("line 1:1000", Expect::kRefusal, {.stretch = {1, 0.001, 0.001}});
  check_scene("collinear", Expect::kRefusal, {.stretch = {1, 0, 0}});
  check_scene("coinciding", Expect::kRefusal, {.stretch = {0, 0, 0}});
  check_scene("all outliers", Expect::kRefusal, {.outliers = 10});
  check_scene("mirrored", Expect::kRefusal, {.mirrored = true});
  check_scene("not a number", Expect::kRefusal, {.nan = true});
  check_scene("two points", Expect::kRefusal, {.points = 2});
}

}  // namespace
}  // namespace mixrig::stability

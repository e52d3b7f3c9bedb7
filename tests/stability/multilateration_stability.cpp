// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "host/estimation/multilateration.h"
#include "tests/stability/harness.h"
#include "tests/support/random_geometry.h"

namespace mixrig::stability {
namespace {

using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

/// How a case differs from eight centres in a cube of 2 m, a point 2 m away, 2 mm of noise.
struct Scene {
  Vector3d stretch = {1, 1, 1};
  Vector3d point = {0.7, -0.4, 2};
  double scale = 1;
  Vector3d origin = {0, 0, 0};
  int centres = 8;
  bool hint = false;
  int outliers = 0;
  bool doubled = false;
  bool nan = false;
};

constexpr double kSigma_m = 2e-3;

Trial run(const Scene& scene, std::uint64_t seed, Residuals& residuals) {
  test::RandomGeometry random(seed);
  Points centres = random.cloud(scene.centres, 1.0);
  for (Vector3d& c : centres) c = scene.origin + scene.scale * c.cwiseProduct(scene.stretch);
  if (scene.doubled)
    centres.insert(centres.end(), centres.begin(), centres.begin() + scene.centres);
  const Vector3d truth = scene.origin + scene.scale * scene.point;
  const double sigma = kSigma_m * scene.scale;
  std::vector<double> ranges;
  for (const Vector3d& c : centres) ranges.push_back((truth - c).norm() + sigma * random.normal());
  for (int i = 0; i < scene.outliers; ++i) ranges[i] = scene.scale * random.uniform(0.5, 4);
  if (scene.nan) ranges[2] = NAN;
  estimation::MultilaterationOptions options{sigma, {}};
  if (scene.hint) options.near_m = truth + 0.5 * scene.scale * Vector3d(0.3, 0.3, 0.9);
  estimation::Estimate<Vector3d> estimate;
  Trial trial =
      timed([&] { return estimation::multilaterate(centres, ranges, options); }, estimate);
  if (!estimate.usable()) return trial;
  trial.error = estimate.value - truth;
  if (scene.outliers > 0) return trial;
  residuals = [centres, ranges, truth, sigma](const Reals& x) {
    Reals r;
    for (std::size_t i = 0; i < centres.size(); ++i) {
      const Reals arm = {Real(truth.x()) - Real(centres[i].x()) + x[0],
                         Real(truth.y()) - Real(centres[i].y()) + x[1],
                         Real(truth.z()) - Real(centres[i].z()) + x[2]};
      r.push_back((length(arm) - Real(ranges[i])) / Real(sigma));
    }
    return r;
  };
  return trial;
}

void check_scene(const std::string& name, Expect expect, const Scene& scene) {
  check({"multilaterate", name, expect, [scene](std::uint64_t seed, Residuals& residuals) {
           return run(scene, seed, residuals);
         }});
}

TEST(MultilaterationStability, WellPosed) {
  check_scene("cube", Expect::kAnswer, {});
  check_scene("inside the cube", Expect::kAnswer, {.point = {0.1, 0.2, -0.1}});
  check_scene("coplanar, side known", Expect::kAnswer, {.stretch = {1, 1, 0}, .hint = true});
  check_scene("flattened 1:10", Expect::kAnswer, {.stretch = {1, 1, 0.1}, .hint = true});
  check_scene("point at 10 spreads", Expect::kAnswer, {.point = {3, 4, 15}});
  check_scene("scale 1e-3", Expect::kAnswer, {.scale = 1e-3});
  check_scene("scale 1e3", Expect::kAnswer, {.scale = 1e3});
  check_scene("1e6 m from the origin", Expect::kAnswer, {.origin = {1e6, -1e6, 1e6}});
  check_scene("every centre twice", Expect::kAnswer, {.doubled = true});
}

TEST(MultilaterationStability, OutliersAndDegenerate) {
  check_scene("one outlier of eight", Expect::kCareful, {.outliers = 1});
  check_scene("flattened 1:100, side unknown", Expect::kCareful, {.stretch = {1, 1, 0.01}});
  check_scene("point at 300 spreads", Expect::kCareful, {.point = {100, 100, 300}});
  check_scene("line 1:100, side known", Expect::kCareful,
              {.stretch = {1, 0.01, 0.01}, .hint = true});
  check_scene("coplanar, side unknown", Expect::kRefusal, {.stretch = {1, 1, 0}});
  check_scene("in the plane of its centres", Expect::kRefusal,
              {.stretch = {1, 1, 0}, .point = {0.2, 0.3, 0}, .hint = true});
  check_scene("collinear", Expect::kRefusal, {.stretch = {1, 0, 0}, .hint = true});
  check_scene("coinciding", Expect::kRefusal, {.stretch = {0, 0, 0}, .hint = true});
  check_scene("all outliers", Expect::kRefusal, {.outliers = 8});
  check_scene("three ranges", Expect::kRefusal, {.centres = 3});
  check_scene("not a number", Expect::kRefusal, {.nan = true});
}

}  // namespace
}  // namespace mixrig::stability

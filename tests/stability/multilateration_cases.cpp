// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/points/multilateration.h"
#include "tests/stability/random_geometry.h"
#include "tests/stability/suite.h"

namespace mixrig::estimation_bench {
namespace {

using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

/// Parameters of a case; the defaults are eight centres in a cube of 2 m, a point 2 m away, 2 mm of
/// noise.
struct RangeScene {
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

constexpr double kRangeSigma_m = 2e-3;

Trial run(const RangeScene& scene, std::uint64_t seed, Residuals& residuals) {
  RandomGeometry random(seed);
  Points centres = random.cloud(scene.centres, 1.0);
  for (Vector3d& c : centres) c = scene.origin + scene.scale * c.cwiseProduct(scene.stretch);
  if (scene.doubled)
    centres.insert(centres.end(), centres.begin(), centres.begin() + scene.centres);
  const Vector3d truth = scene.origin + scene.scale * scene.point;
  const double sigma = kRangeSigma_m * scene.scale;
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

}  // namespace

void add_multilateration_cases(std::vector<Case>& cases) {
  const auto add = case_adder<RangeScene>(cases, "multilaterate", run);
  add("cube", Expect::kAnswer, {});
  add("inside the cube", Expect::kAnswer, {.point = {0.1, 0.2, -0.1}});
  add("coplanar, side known", Expect::kAnswer, {.stretch = {1, 1, 0}, .hint = true});
  add("flattened 1:10", Expect::kAnswer, {.stretch = {1, 1, 0.1}, .hint = true});
  add("point at 10 spreads", Expect::kAnswer, {.point = {3, 4, 15}});
  add("scale 1e-3", Expect::kAnswer, {.scale = 1e-3});
  add("scale 1e3", Expect::kAnswer, {.scale = 1e3});
  add("1e6 m from the origin", Expect::kAnswer, {.origin = {1e6, -1e6, 1e6}});
  add("every centre twice", Expect::kAnswer, {.doubled = true});
  add("one outlier of eight", Expect::kRobust, {.outliers = 1});
  add("flattened 1:100, side unknown", Expect::kCareful, {.stretch = {1, 1, 0.01}});
  add("point at 300 spreads", Expect::kCareful, {.point = {100, 100, 300}});
  add("line 1:100, side known", Expect::kCareful, {.stretch = {1, 0.01, 0.01}, .hint = true});
  add("coplanar, side unknown", Expect::kRefusal, {.stretch = {1, 1, 0}});
  add("in the plane of its centres", Expect::kRefusal,
      {.stretch = {1, 1, 0}, .point = {0.2, 0.3, 0}, .hint = true});
  add("collinear", Expect::kRefusal, {.stretch = {1, 0, 0}, .hint = true});
  add("coinciding", Expect::kRefusal, {.stretch = {0, 0, 0}, .hint = true});
  add("all outliers", Expect::kRefusal, {.outliers = 8});
  add("three ranges", Expect::kRefusal, {.centres = 3});
  add("not a number", Expect::kRefusal, {.nan = true});
  for (const double height : {1.0, 0.3, 0.1, 0.03, 0.01, 0.003, 0.001})
    add("height " + shown(height), Expect::kCareful, {.stretch = {1, 1, height}},
        "height of the centres over their width", height);
}

}  // namespace mixrig::estimation_bench

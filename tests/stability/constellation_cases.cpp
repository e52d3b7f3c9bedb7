// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "host/math/estimation/markers/constellation.h"
#include "tests/stability/random_geometry.h"
#include "tests/stability/suite.h"

namespace mixrig::estimation_bench {
namespace {

using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

/// Parameters of a case; the defaults are a body of five markers over 20 cm, seen with 0.5 mm of
/// noise.
struct ConstellationScene {
  double skew_m = 0.04;  ///< how far the third corner of the base is from making it isosceles
  double apex_m = 0.05;  ///< height of the other markers over the base
  int markers = 5;
  int missing = 0, foreign = 0;
  bool unrelated = false;
  bool nan = false;
  double scale = 1;
};

constexpr double kConstellationSigma_m = 5e-4;

/// An isosceles base (except for `skew_m`) with both other markers on its plane of symmetry.
Points body_of(const ConstellationScene& s) {
  Points body = {{-0.1, 0, 0},
                 {0.1, 0, 0},
                 {s.skew_m, 0.15, 0},
                 {0, 0.05, s.apex_m},
                 {0, -0.04, 2 * s.apex_m}};
  body.resize(s.markers);
  for (Vector3d& p : body) p *= s.scale;
  return body;
}

Trial run(const ConstellationScene& scene, std::uint64_t seed, Residuals& residuals) {
  RandomGeometry random(seed);
  const Points body = body_of(scene);
  const double sigma_m = kConstellationSigma_m * scene.scale;
  const geometry::Pose truth = random.pose(2 * scene.scale);
  Points used, seen;
  for (std::size_t i = scene.missing; i < body.size(); ++i) {
    used.push_back(body[i]);
    seen.push_back(truth * body[i] + random.normal3(sigma_m));
    if (scene.unrelated) seen.back() = scene.scale * random.in_box(0.15);
  }
  Points observed = seen;
  for (int i = 0; i < scene.foreign; ++i)
    observed.push_back(truth.translation_m + scene.scale * random.in_box(0.5));
  std::reverse(observed.begin(), observed.end());
  if (scene.nan) observed[1].z() = NAN;
  estimation::Estimate<estimation::ConstellationMatch> estimate;
  Trial trial = timed(
      [&] {
        return estimation::match_constellation(body, observed, {sigma_m, 0});
      },
      estimate);
  if (!estimate.usable()) return trial;
  trial.error = estimation::pose_error(estimate.value.world_from_body, truth);
  residuals = [used, seen, truth, sigma_m](const Reals& x) {
    const Motion m = moved(truth, x);
    Reals r;
    for (std::size_t i = 0; i < used.size(); ++i) {
      const Reals p = mapped(m, reals(used[i]));
      for (int k = 0; k < 3; ++k) r.push_back((p[k] - Real(seen[i][k])) / Real(sigma_m));
    }
    return r;
  };
  return trial;
}

}  // namespace

void add_constellation_cases(std::vector<Case>& cases) {
  const auto add = case_adder<ConstellationScene>(cases, "match_constellation", run);
  add("five markers", Expect::kAnswer, {});
  add("one missing", Expect::kAnswer, {.missing = 1});
  add("one missing, four foreign", Expect::kAnswer, {.missing = 1, .foreign = 4});
  add("scale 1e-3", Expect::kAnswer, {.scale = 1e-3});
  add("scale 1e3", Expect::kAnswer, {.scale = 1e3});
  add("three of three", Expect::kAnswer, {.markers = 3});
  add("twenty foreign", Expect::kCareful, {.foreign = 20});
  add("coplanar, isosceles", Expect::kRefusal, {.skew_m = 0, .apex_m = 0});
  add("isosceles triangle", Expect::kRefusal, {.skew_m = 0, .markers = 3});
  add("two missing", Expect::kRefusal, {.missing = 2});
  add("unrelated points", Expect::kRefusal, {.unrelated = true});
  add("not a number", Expect::kRefusal, {.nan = true});
  for (const double skew : {0.04, 0.02, 0.01, 0.005, 0.002, 0.001, 0.0001})
    add("off symmetry by " + shown(1000 * skew) + " mm", Expect::kCareful,
        {.skew_m = skew, .apex_m = 0}, "off symmetry, m", skew);
}

}  // namespace mixrig::estimation_bench

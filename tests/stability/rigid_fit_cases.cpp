// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/points/rigid_fit.h"
#include "tests/stability/random_geometry.h"
#include "tests/stability/suite.h"

namespace mixrig::estimation_bench {
namespace {

using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

/// Parameters of a case; the defaults are ten points in a cube of 2 m under 1 mm of noise.
struct RigidScene {
  Vector3d stretch = {1, 1, 1};  ///< factors of the cloud's axes
  double scale = 1;              ///< factor of cloud and noise
  Vector3d origin = {0, 0, 0};   ///< centre of the cloud
  std::optional<Vector3d> turn_rad = std::nullopt;
  int points = 10;
  int outliers = 0;
  bool doubled = false;
  bool nan = false;
  bool mirrored = false;
  bool with_scale = false;  ///< similarity_fit, true scale 1.7
};

constexpr double kRigidSigma_m = 1e-3;

/// Both point sets and the transform between them.
struct Data {
  Points a, b;
  estimation::Similarity truth;
  double sigma_m = kRigidSigma_m;

  Vector3d centre() const {
    Vector3d sum = Vector3d::Zero();
    for (const Vector3d& p : a) sum += p - a[0];
    return a[0] + sum / static_cast<double>(a.size());
  }
};

Data data_of(const RigidScene& scene, std::uint64_t seed) {
  RandomGeometry random(seed);
  Data d{random.cloud(scene.points, 1.0), {}, {}, kRigidSigma_m * scene.scale};
  d.truth.pose = random.pose(2 * scene.scale);
  if (scene.with_scale) d.truth.scale = 1.7;
  if (scene.turn_rad) d.truth.pose.rotation = estimation::rotation_exp(*scene.turn_rad);
  for (Vector3d& p : d.a) p = scene.origin + scene.scale * p.cwiseProduct(scene.stretch);
  if (scene.doubled) d.a.insert(d.a.end(), d.a.begin(), d.a.begin() + scene.points);
  for (const Vector3d& p : d.a) d.b.push_back(d.truth * p + random.normal3(d.sigma_m));
  for (int i = 0; i < scene.outliers; ++i) d.b[i] = random.in_box(3);
  if (scene.nan) d.b[1].y() = NAN;
  if (scene.mirrored)
    for (Vector3d& p : d.b) p.x() = -p.x();
  return d;
}

Residuals model_of(const Data& d, bool with_scale) {
  return [d, with_scale](const Reals& x) {
    // The error is taken about the middle c of the cloud: c goes to truth * c, whatever rotation
    // and scale do.
    const Vector3d c = d.centre();
    const Motion m = moved_about(d.truth.pose, d.truth.scale * c, x);
    const Real gain = with_scale ? Real(d.truth.scale) * exp(x[6]) : Real(d.truth.scale);
    Reals r;
    for (std::size_t i = 0; i < d.a.size(); ++i) {
      Reals p = reals(d.truth.scale * c);
      for (int k = 0; k < 3; ++k) p[k] += gain * (Real(d.a[i][k]) - Real(c[k]));
      p = mapped(m, p);
      for (int k = 0; k < 3; ++k) r.push_back((p[k] - Real(d.b[i][k])) / Real(d.sigma_m));
    }
    return r;
  };
}

Trial run(const RigidScene& scene, std::uint64_t seed, Residuals& residuals) {
  const Data d = data_of(scene, seed);
  const estimation::RigidFitOptions options{d.sigma_m, {}};
  PoseChart chart{d.centre(), {}};
  Trial trial;
  if (scene.with_scale) {
    estimation::Estimate<estimation::Similarity> estimate;
    trial = timed([&] { return estimation::similarity_fit(d.a, d.b, options); }, estimate);
    if (!estimate.usable()) return trial;
    Eigen::Matrix<double, 7, 1> error;
    error << estimation::pose_error(estimate.value.pose, d.truth.pose),
        std::log(estimate.value.scale / d.truth.scale);
    chart.arm = estimate.value.scale * (estimate.value.pose.rotation * chart.centre);
    trial.error = chart.error(error, estimate.value * chart.centre, d.truth * chart.centre);
  } else {
    estimation::Estimate<geometry::Pose> estimate;
    trial = timed([&] { return estimation::rigid_fit(d.a, d.b, options); }, estimate);
    if (!estimate.usable()) return trial;
    chart.arm = estimate.value.rotation * chart.centre;
    trial.error = chart.error(estimation::pose_error(estimate.value, d.truth.pose),
                              estimate.value * chart.centre, d.truth * chart.centre);
  }
  trial.covariance = chart.covariance(trial.covariance);
  if (scene.outliers == 0) residuals = model_of(d, scene.with_scale);
  return trial;
}

}  // namespace

void add_rigid_fit_cases(std::vector<Case>& cases) {
  const auto add = [&](const std::string& name, Expect expect, const RigidScene& scene,
                       const std::string& axis = {}, double at = NAN) {
    cases.push_back({scene.with_scale ? "similarity_fit" : "rigid_fit", name, expect,
                     [scene](std::uint64_t seed, Residuals& r) { return run(scene, seed, r); },
                     axis, at});
  };
  add("cube", Expect::kAnswer, {});
  add("coplanar", Expect::kAnswer, {.stretch = {1, 1, 0}});
  add("three points", Expect::kAnswer, {.points = 3});
  add("half turn about x", Expect::kAnswer, {.turn_rad = Vector3d(M_PI, 0, 0)});
  add("half turn about a diagonal", Expect::kAnswer,
      {.turn_rad = M_PI * Vector3d(1, 1, 1).normalized()});
  add("gimbal lock, pitch 90 deg", Expect::kAnswer, {.turn_rad = Vector3d(0, M_PI / 2, 0)});
  add("scale 1e-3", Expect::kAnswer, {.scale = 1e-3});
  add("scale 1e3", Expect::kAnswer, {.scale = 1e3});
  add("1e6 m from the origin", Expect::kAnswer, {.origin = {1e6, -1e6, 1e6}});
  add("every point twice", Expect::kAnswer, {.doubled = true});
  add("flattened to a line 1:10", Expect::kAnswer, {.stretch = {1, 0.1, 0.1}});
  add("flattened to a line 1:100", Expect::kAnswer, {.stretch = {1, 0.02, 0.02}});
  add("one outlier of ten", Expect::kRobust, {.outliers = 1});
  add("four outliers of ten", Expect::kCareful, {.outliers = 4});
  add("line 1:1000", Expect::kRefusal, {.stretch = {1, 0.001, 0.001}});
  add("collinear", Expect::kRefusal, {.stretch = {1, 0, 0}});
  add("coinciding", Expect::kRefusal, {.stretch = {0, 0, 0}});
  add("all outliers", Expect::kRefusal, {.outliers = 10});
  add("mirrored", Expect::kRefusal, {.mirrored = true});
  add("not a number", Expect::kRefusal, {.nan = true});
  add("two points", Expect::kRefusal, {.points = 2});
  add("cube", Expect::kAnswer, {.with_scale = true});
  add("coplanar", Expect::kAnswer, {.stretch = {1, 1, 0}, .with_scale = true});
  add("three points", Expect::kAnswer, {.points = 3, .with_scale = true});
  add("scale 1e3", Expect::kAnswer, {.scale = 1e3, .with_scale = true});
  add("1e6 m from the origin", Expect::kAnswer, {.origin = {1e6, -1e6, 1e6}, .with_scale = true});
  add("one outlier of ten", Expect::kRobust, {.outliers = 1, .with_scale = true});
  add("collinear", Expect::kRefusal, {.stretch = {1, 0, 0}, .with_scale = true});
  add("all outliers", Expect::kRefusal, {.outliers = 10, .with_scale = true});
  add("mirrored", Expect::kRefusal, {.mirrored = true, .with_scale = true});
  for (const double width : {1.0, 0.3, 0.1, 0.03, 0.01, 0.003, 0.001})
    add("width " + shown(width), Expect::kCareful, {.stretch = {1, width, width}},
        "width of the cloud over its length", width);
}

}  // namespace mixrig::estimation_bench

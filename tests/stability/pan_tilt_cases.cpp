// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/pose/pan_tilt_chain.h"
#include "tests/stability/random_geometry.h"
#include "tests/stability/suite.h"

namespace mixrig::estimation_bench {
namespace {

using Eigen::Vector3d;
using estimation::PanTiltView;
using geometry::Pose;

/// Parameters of a case; the defaults are sixteen views within +-40 deg of pan and +-25 deg of tilt
/// of a target 1.6 m away, noise 0.3 mrad and 0.3 mm.
struct PanTiltScene {
  double pan_rad = 0.7, tilt_rad = 0.44;
  double skew_rad = 0.007;
  double scale = 1;  ///< factor of all lengths
  int views = 16;
  int outliers = 0;
  double angle_sigma_rad = 0;
  bool swapped = false;  ///< whether the angles of the two axes are swapped
  bool nan = false;
};

constexpr double kPanTiltSigma_rad = 3e-4, kPanTiltSigma_m = 3e-4;

estimation::PanTiltCalibration truth_of(const PanTiltScene& scene) {
  estimation::PanTiltCalibration truth;
  truth.chain = {
      scene.skew_rad,
      0.003 * scene.scale,
      1.002,
      1.005,
      {estimation::rotation_exp({-1.5, 0.1, 0.05}), scene.scale * Vector3d(0.04, 0.11, 0.07)}};
  truth.base_from_target = {estimation::rotation_exp({1.6, 0.2, -0.1}),
                            scene.scale * Vector3d(0.3, 1.6, 0.2)};
  return truth;
}

std::vector<PanTiltView> views_of(const PanTiltScene& scene,
                                  const estimation::PanTiltCalibration& truth,
                                  RandomGeometry& random) {
  const double sigma_m = kPanTiltSigma_m * scene.scale;
  std::vector<PanTiltView> views;
  for (int i = 0; i < scene.views; ++i) {
    PanTiltView view;
    view.pan_rad = scene.pan_rad * random.uniform(-1, 1);
    view.tilt_rad = scene.tilt_rad * random.uniform(-1, 1);
    const Pose camera = estimation::base_from_camera(
        truth.chain, view.pan_rad + scene.angle_sigma_rad * random.normal() / truth.chain.pan_scale,
        view.tilt_rad + scene.angle_sigma_rad * random.normal() / truth.chain.tilt_scale);
    Pose& seen = view.camera_from_target;
    seen = geometry::inverse(camera) * truth.base_from_target;
    seen.rotation = estimation::rotation_exp(random.normal3(kPanTiltSigma_rad)) * seen.rotation;
    seen.translation_m += random.normal3(sigma_m);
    if (i < scene.outliers) seen = {random.rotation(), scene.scale * random.in_box(2)};
    view.covariance.diagonal() << Vector3d::Constant(kPanTiltSigma_rad * kPanTiltSigma_rad),
        Vector3d::Constant(sigma_m * sigma_m);
    if (scene.swapped) std::swap(view.pan_rad, view.tilt_rad);
    if (scene.nan && i == 0) seen.translation_m.x() = NAN;
    views.push_back(view);
  }
  return views;
}

/// Rotation by `angle` about the unit axis (x, 0, z), in front of motion `m`.
Motion turned(const Real& x, const Real& z, const Real& angle, const Motion& m) {
  const Real c = cos(angle), s = sin(angle), v = 1 - c;
  const Real r[3][3] = {
      {c + x * x * v, -z * s, x * z * v}, {z * s, c, -x * s}, {x * z * v, x * s, c + z * z * v}};
  Motion out;
  for (int i = 0; i < 3; ++i) {
    out.t[i] = 0;
    for (int k = 0; k < 3; ++k) {
      out.t[i] += r[i][k] * m.t[k];
      out.r[i][k] = 0;
      for (int j = 0; j < 3; ++j) out.r[i][k] += r[i][j] * m.r[j][k];
    }
  }
  return out;
}

/// Model of the target points in 50 digits, from the axes as the header of the estimator defines
/// them.
Residuals chain_model(const std::vector<PanTiltView>& views,
                      const estimation::PanTiltCalibration& truth, double sigma_m) {
  std::vector<Motion> eyes;
  for (const PanTiltView& view : views)
    eyes.push_back(moved(view.camera_from_target, Reals(6, Real(0))));
  return [=](const Reals& x) {
    const estimation::PanTiltChain& c = truth.chain;
    const Real skew = Real(c.skew_rad) + x[0], offset = Real(c.offset_m) + x[1];
    const Real tilt_x = cos(skew), tilt_z = sin(skew);
    const Motion head_from_camera = moved(c.head_from_camera, x, 4);
    const Motion base_from_target = moved(truth.base_from_target, x, 10);
    Reals r;
    for (std::size_t i = 0; i < views.size(); ++i) {
      const PanTiltView& view = views[i];
      Motion camera =
          turned(tilt_x, tilt_z, (Real(c.tilt_scale) + x[3]) * view.tilt_rad, head_from_camera);
      camera.t[1] += offset;
      camera = turned(Real(0), Real(1), (Real(c.pan_scale) + x[2]) * view.pan_rad, camera);
      add_pose_residuals(camera, base_from_target, eyes[i], Real(kPanTiltSigma_rad), Real(sigma_m),
                         r);
    }
    return r;
  };
}

Trial run(const PanTiltScene& scene, std::uint64_t seed, Residuals& residuals) {
  RandomGeometry random(seed);
  const auto truth = truth_of(scene);
  const auto views = views_of(scene, truth, random);
  estimation::Estimate<estimation::PanTiltCalibration> estimate;
  Trial trial =
      timed([&] { return estimation::calibrate_pan_tilt(views, scene.angle_sigma_rad); }, estimate);
  if (!estimate.usable()) return trial;
  const auto& chain = estimate.value.chain;
  trial.error.resize(16);
  trial.error << chain.skew_rad - truth.chain.skew_rad, chain.offset_m - truth.chain.offset_m,
      chain.pan_scale - truth.chain.pan_scale, chain.tilt_scale - truth.chain.tilt_scale,
      estimation::pose_error(chain.head_from_camera, truth.chain.head_from_camera),
      estimation::pose_error(estimate.value.base_from_target, truth.base_from_target);
  if (scene.outliers == 0 && scene.angle_sigma_rad == 0)
    residuals = chain_model(views, truth, kPanTiltSigma_m * scene.scale);
  return trial;
}

}  // namespace

void add_pan_tilt_cases(std::vector<Case>& cases) {
  const auto add = case_adder<PanTiltScene>(cases, "calibrate_pan_tilt", run);
  add("16 views", Expect::kAnswer, {});
  add("40 views", Expect::kAnswer, {.views = 40});
  add("square axes", Expect::kAnswer, {.skew_rad = 0});
  add("pan all around", Expect::kAnswer, {.pan_rad = M_PI});
  add("tilt of +-10 deg", Expect::kAnswer, {.tilt_rad = 0.175});
  add("scale 1e-3", Expect::kAnswer, {.scale = 1e-3});
  add("scale 1e3", Expect::kAnswer, {.scale = 1e3});
  add("repeatability 0.5 mrad", Expect::kCareful, {.angle_sigma_rad = 5e-4});
  add("one outlier of sixteen", Expect::kRobust, {.outliers = 1});
  add("five views", Expect::kCareful, {.views = 5});
  add("pan alone", Expect::kRefusal, {.tilt_rad = 0});
  add("tilt alone", Expect::kRefusal, {.pan_rad = 0});
  add("axes swapped", Expect::kRefusal, {.swapped = true});
  add("all outliers", Expect::kRefusal, {.outliers = 16});
  add("three views", Expect::kRefusal, {.views = 3});
  add("not a number", Expect::kRefusal, {.nan = true});
  for (const double turn : {0.44, 0.2, 0.1, 0.05, 0.02, 0.012})
    add("tilt " + shown(turn) + " rad", Expect::kCareful, {.tilt_rad = turn}, "greatest tilt, rad",
        turn);
}

}  // namespace mixrig::estimation_bench

// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "host/estimation/hand_eye.h"
#include "tests/stability/harness.h"
#include "tests/support/random_geometry.h"

namespace mixrig::stability {
namespace {

using Eigen::Vector3d;
using geometry::Pose;

/// How a case differs from ten views within +-30 deg and 1 m, noise 1 mrad and 1 mm.
struct Scene {
  Vector3d turn_rad = {0.5, 0.5, 0.5};  ///< greatest rotation of the hand about each axis
  Vector3d base_rad = {0, 0, 0};        ///< rotation that all views share
  double scale = 1;
  int views = 10;
  int outliers = 0;
  bool nan = false;
};

constexpr double kSigma_rad = 1e-3, kSigma_m = 1e-3;

Residuals chain_model(const std::vector<Pose>& hands, const std::vector<Pose>& eyes,
                      const estimation::HandEye& truth, double sigma_m) {
  return [=](const Reals& x) {
    const Motion hand_from_eye = moved(truth.hand_from_eye, x, 0);
    const Motion world_from_target = moved(truth.world_from_target, x, 6);
    const Reals none(6, Real(0));
    Reals r;
    for (std::size_t i = 0; i < hands.size(); ++i) {
      const Motion hand = moved(hands[i], none), eye = moved(eyes[i], none);
      const auto to_eye = [&](const Reals& p) {
        return mapped_back(hand_from_eye, mapped_back(hand, mapped(world_from_target, p)));
      };
      const Reals centre = to_eye({Real(0), Real(0), Real(0)});
      // Rotation off the measured one, from where the target's axes point.
      Real turn[3][3];
      for (int c = 0; c < 3; ++c) {
        Reals axis(3, Real(0));
        axis[c] = 1;
        Reals tip = to_eye(axis);
        for (int k = 0; k < 3; ++k) turn[k][c] = tip[k] - centre[k];
      }
      Real off[3][3];
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
          off[a][b] =
              turn[a][0] * eye.r[b][0] + turn[a][1] * eye.r[b][1] + turn[a][2] * eye.r[b][2];
      const Real w[3] = {(off[2][1] - off[1][2]) / 2, (off[0][2] - off[2][0]) / 2,
                         (off[1][0] - off[0][1]) / 2};
      const Real sine = sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
      const Real gain = sine > Real("1e-15") ? asin(sine) / sine : Real(1);
      for (const Real& value : w) r.push_back(gain * value / Real(kSigma_rad));
      for (int k = 0; k < 3; ++k) r.push_back((centre[k] - eye.t[k]) / Real(sigma_m));
    }
    return r;
  };
}

Trial run(const Scene& scene, std::uint64_t seed, Residuals& residuals) {
  test::RandomGeometry random(seed);
  const double sigma_m = kSigma_m * scene.scale;
  const estimation::HandEye truth{{random.rotation(), scene.scale * Vector3d(0.05, 0.02, 0.1)},
                                  {random.rotation(), scene.scale * Vector3d(0.5, 1, 2)}};
  std::vector<Pose> hands, eyes;
  for (int i = 0; i < scene.views; ++i) {
    const Vector3d turn = random.in_box(1).cwiseProduct(scene.turn_rad);
    const Pose hand{estimation::rotation_exp(turn) * estimation::rotation_exp(scene.base_rad),
                    scene.scale * random.in_box(0.5)};
    Pose eye = geometry::inverse(hand * truth.hand_from_eye) * truth.world_from_target;
    eye.rotation = estimation::rotation_exp(random.normal3(kSigma_rad)) * eye.rotation;
    eye.translation_m += random.normal3(sigma_m);
    if (i < scene.outliers) eye = {random.rotation(), scene.scale * random.in_box(2)};
    if (scene.nan && i == 0) eye.translation_m.x() = NAN;
    hands.push_back(hand);
    eyes.push_back(eye);
  }
  estimation::Estimate<estimation::HandEye> estimate;
  Trial trial = timed(
      [&] {
        return estimation::solve_hand_eye(hands, eyes, {kSigma_rad, sigma_m});
      },
      estimate);
  if (!estimate.usable()) return trial;
  trial.error.resize(12);
  trial.error << estimation::pose_error(estimate.value.hand_from_eye, truth.hand_from_eye),
      estimation::pose_error(estimate.value.world_from_target, truth.world_from_target);
  if (scene.outliers == 0) residuals = chain_model(hands, eyes, truth, sigma_m);
  return trial;
}

void check_scene(const std::string& name, Expect expect, const Scene& scene) {
  check({"solve_hand_eye", name, expect,
         [scene](std::uint64_t seed, Residuals& residuals) { return run(scene, seed, residuals); },
         40});
}

TEST(HandEyeStability, WellPosed) {
  check_scene("30 deg about all axes", Expect::kAnswer, {});
  check_scene("10 deg about all axes", Expect::kAnswer, {.turn_rad = {0.17, 0.17, 0.17}});
  check_scene("two axes", Expect::kAnswer, {.turn_rad = {0.5, 0.5, 0}});
  check_scene("all about a half turn", Expect::kAnswer, {.base_rad = {M_PI, 0, 0}});
  check_scene("gimbal lock, pitch 90 deg", Expect::kAnswer, {.base_rad = {0, M_PI / 2, 0}});
  check_scene("half turns apart", Expect::kAnswer, {.turn_rad = {3, 3, 3}});
  check_scene("scale 1e-3", Expect::kAnswer, {.scale = 1e-3});
  check_scene("scale 1e3", Expect::kAnswer, {.scale = 1e3});
  check_scene("second axis 5 deg", Expect::kAnswer, {.turn_rad = {0, 0.09, 0.5}});
}

TEST(HandEyeStability, OutliersAndDegenerate) {
  check_scene("one outlier of ten", Expect::kCareful, {.outliers = 1});
  check_scene("second axis 1 deg", Expect::kCareful, {.turn_rad = {0, 0.017, 0.5}});
  check_scene("three views", Expect::kCareful, {.views = 3});
  check_scene("one axis", Expect::kRefusal, {.turn_rad = {0, 0, 0.5}});
  check_scene("no rotation", Expect::kRefusal, {.turn_rad = {0, 0, 0}});
  check_scene("all outliers", Expect::kRefusal, {.outliers = 10});
  check_scene("two views", Expect::kRefusal, {.views = 2});
  check_scene("not a number", Expect::kRefusal, {.nan = true});
}

}  // namespace
}  // namespace mixrig::stability

// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/pose/hand_eye.h"
#include "tests/stability/random_geometry.h"
#include "tests/stability/suite.h"

namespace mixrig::estimation_bench {
namespace {

using Eigen::Vector3d;
using geometry::Pose;

/// Parameters of a case; the defaults are ten views within +-30 deg and 1 m, noise 1 mrad and 1 mm.
struct HandEyeScene {
  Vector3d turn_rad = {0.5, 0.5, 0.5};  ///< greatest rotation of the hand about each axis
  Vector3d base_rad = {0, 0, 0};        ///< rotation that all views share
  double scale = 1;
  int views = 10;
  int outliers = 0;
  bool nan = false;
};

constexpr double kHandEyeSigma_rad = 1e-3, kHandEyeSigma_m = 1e-3;

Residuals chain_model(const std::vector<Pose>& hands, const std::vector<Pose>& eyes,
                      const estimation::HandEye& truth, double sigma_m) {
  const Reals none(6, Real(0));
  std::vector<Motion> hand, eye;
  for (std::size_t i = 0; i < hands.size(); ++i) {
    hand.push_back(moved(hands[i], none));
    eye.push_back(moved(eyes[i], none));
  }
  return [=](const Reals& x) {
    const Motion hand_from_eye = moved(truth.hand_from_eye, x, 0);
    const Motion world_from_target = moved(truth.world_from_target, x, 6);
    Reals r;
    for (std::size_t i = 0; i < hand.size(); ++i)
      add_pose_residuals(product(hand[i], hand_from_eye), world_from_target, eye[i],
                         Real(kHandEyeSigma_rad), Real(sigma_m), r);
    return r;
  };
}

Trial run(const HandEyeScene& scene, std::uint64_t seed, Residuals& residuals) {
  RandomGeometry random(seed);
  const double sigma_m = kHandEyeSigma_m * scene.scale;
  const estimation::HandEye truth{{random.rotation(), scene.scale * Vector3d(0.05, 0.02, 0.1)},
                                  {random.rotation(), scene.scale * Vector3d(0.5, 1, 2)}};
  std::vector<Pose> hands, eyes;
  for (int i = 0; i < scene.views; ++i) {
    const Vector3d turn = random.in_box(1).cwiseProduct(scene.turn_rad);
    const Pose hand{estimation::rotation_exp(turn) * estimation::rotation_exp(scene.base_rad),
                    scene.scale * random.in_box(0.5)};
    Pose eye = geometry::inverse(hand * truth.hand_from_eye) * truth.world_from_target;
    eye.rotation = estimation::rotation_exp(random.normal3(kHandEyeSigma_rad)) * eye.rotation;
    eye.translation_m += random.normal3(sigma_m);
    if (i < scene.outliers) eye = {random.rotation(), scene.scale * random.in_box(2)};
    if (scene.nan && i == 0) eye.translation_m.x() = NAN;
    hands.push_back(hand);
    eyes.push_back(eye);
  }
  estimation::Estimate<estimation::HandEye> estimate;
  Trial trial = timed(
      [&] {
        return estimation::solve_hand_eye(hands, eyes, {kHandEyeSigma_rad, sigma_m});
      },
      estimate);
  if (!estimate.usable()) return trial;
  trial.error.resize(12);
  trial.error << estimation::pose_error(estimate.value.hand_from_eye, truth.hand_from_eye),
      estimation::pose_error(estimate.value.world_from_target, truth.world_from_target);
  if (scene.outliers == 0) residuals = chain_model(hands, eyes, truth, sigma_m);
  return trial;
}

}  // namespace

void add_hand_eye_cases(std::vector<Case>& cases) {
  const auto add = case_adder<HandEyeScene>(cases, "solve_hand_eye", run);
  add("30 deg about all axes", Expect::kAnswer, {});
  add("10 deg about all axes", Expect::kAnswer, {.turn_rad = {0.17, 0.17, 0.17}});
  add("two axes", Expect::kAnswer, {.turn_rad = {0.5, 0.5, 0}});
  add("all about a half turn", Expect::kAnswer, {.base_rad = {M_PI, 0, 0}});
  add("gimbal lock, pitch 90 deg", Expect::kAnswer, {.base_rad = {0, M_PI / 2, 0}});
  add("half turns apart", Expect::kAnswer, {.turn_rad = {3, 3, 3}});
  add("scale 1e-3", Expect::kAnswer, {.scale = 1e-3});
  add("scale 1e3", Expect::kAnswer, {.scale = 1e3});
  add("second axis 5 deg", Expect::kAnswer, {.turn_rad = {0, 0.09, 0.5}});
  add("one outlier of ten", Expect::kRobust, {.outliers = 1});
  add("second axis 1 deg", Expect::kCareful, {.turn_rad = {0, 0.017, 0.5}});
  add("three views", Expect::kCareful, {.views = 3});
  add("one axis", Expect::kRefusal, {.turn_rad = {0, 0, 0.5}});
  add("no rotation", Expect::kRefusal, {.turn_rad = {0, 0, 0}});
  add("all outliers", Expect::kRefusal, {.outliers = 10});
  add("two views", Expect::kRefusal, {.views = 2});
  add("not a number", Expect::kRefusal, {.nan = true});
  for (const double turn : {0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.003})
    add("second axis " + shown(turn) + " rad", Expect::kCareful, {.turn_rad = {0, turn, 0.5}},
        "greatest turn about the second axis, rad", turn);
}

}  // namespace mixrig::estimation_bench

// SPDX-License-Identifier: Apache-2.0
// Measured exposures state no covariance: their errors are held to half a percent, which the light
// of a room needs.
#include "hal/base/srgb.h"
#include "host/room/scan/panorama/view_light.h"
#include "tests/stability/random_geometry.h"
#include "tests/stability/suite.h"

namespace mixrig::estimation_bench {
namespace {

/// Parameters of a case; the defaults are a plate of 96 x 64 px with light from 0.01 to 1.2, and
/// one at a quarter of its exposure, by a sensor of 10,000 electrons.
struct BracketScene {
  double exposure = 0.25;  ///< nominal
  double stray = 1.02;     ///< factor by which the camera takes it
  double electrons = 1e4;  ///< of a white pixel
  double dark = 0.01;      ///< light of the darkest pixel
  double people = 0;       ///< share of columns in which something moved
  double beyond = 1;       ///< factor on all light
};

constexpr double kWanted = 0.005;
constexpr Size kBracketPlate{96, 64};

double light_of(const BracketScene& scene, int x) {
  return scene.beyond * scene.dark * std::pow(1.2 / scene.dark, x / 95.0);
}

Image<Rgb8> plate_at(const BracketScene& scene, double factor, bool is_moved,
                     RandomGeometry& random) {
  Image<Rgb8> plate(kBracketPlate);
  for (int y = 0; y < plate.height(); ++y)
    for (int x = 0; x < plate.width(); ++x) {
      const bool is_person = is_moved && (x * 37 % 96) < scene.people * 96;
      const double light = is_person ? random.uniform(0.005, 1) : light_of(scene, x);
      const auto byte = [&](double share) {
        const double charge = scene.electrons * share * factor * light;
        const double noisy = charge + std::sqrt(charge + 64) * random.normal();
        return srgb_byte_from_linear(static_cast<float>(noisy / scene.electrons));
      };
      plate.at(x, y) = {byte(1), byte(0.9), byte(0.8)};
    }
  return plate;
}

Trial run(const BracketScene& scene, std::uint64_t seed, Residuals&) {
  RandomGeometry random(seed);
  std::vector<model::ScanView> views(1);
  views[0].plate = plate_at(scene, 1, false, random);
  views[0].brackets.push_back(
      {scene.exposure, plate_at(scene, scene.exposure * scene.stray, true, random)});
  estimation::Estimate<double> estimate;
  const auto find = [&] {
    const auto found = model::find_exposures(views);
    estimation::Estimate<double> of;
    of.verdict = estimation::Verdict::degenerate("no exposure was measured");
    for (const model::FoundExposure& one : found)
      if (one.nominal == scene.exposure && one.used && one.samples > 0)
        of.value = one.measured, of.verdict = estimation::Verdict::ok();
    of.covariance = Eigen::MatrixXd::Constant(1, 1, kWanted * kWanted);
    return of;
  };
  Trial trial = timed(find, estimate);
  if (!estimate.usable()) return trial;
  trial.error =
      Eigen::VectorXd::Constant(1, std::log(estimate.value / (scene.exposure * scene.stray)));
  return trial;
}

}  // namespace

void add_exposure_cases(std::vector<Case>& cases) {
  const auto add = case_adder<BracketScene>(cases, "find_exposures", run);
  add("a quarter", Expect::kRobust, {});
  add("four times", Expect::kRobust, {.exposure = 4});
  add("an eighth", Expect::kRobust, {.exposure = 0.125});
  add("as stated", Expect::kRobust, {.stray = 1});
  add("40 % off", Expect::kRobust, {.stray = 1.4});
  add("1000 electrons", Expect::kRobust, {.electrons = 1e3});
  add("a dark room", Expect::kRobust, {.dark = 0.002, .beyond = 0.25});
  add("people in a fifth", Expect::kRobust, {.people = 0.2});
  add("a factor of two off", Expect::kRefusal, {.stray = 2});
  add("black", Expect::kRefusal, {.beyond = 1e-4});
  add("white", Expect::kRefusal, {.dark = 1, .beyond = 50});
  for (const double share : {0.1, 0.2, 0.3, 0.4})
    add("people " + shown(share), Expect::kCareful, {.people = share}, "share that moved", share);
}

}  // namespace mixrig::estimation_bench

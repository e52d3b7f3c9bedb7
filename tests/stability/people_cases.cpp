// SPDX-License-Identifier: Apache-2.0
// The covariance of a person's place holds what real bodies differ by: it is modest for the upright
// cylinders of these cases.
#include "extras/people/plan/people_tracker.h"
#include "tests/stability/random_geometry.h"
#include "tests/stability/suite.h"
#include "tests/unit/plan/standing_people.h"

namespace mixrig::estimation_bench {
namespace {

using Eigen::Vector2d;

/// Parameters of a case; the defaults are a second of somebody who stands 3.5 m away, turned any
/// way, seen with 1 cm of noise a pixel.
struct WalkerScene {
  double away_m = 3.5;
  double speed_m_s = 0;
  double rate_hz = 25;
  double sigma_m = 0.01;
  double size = 1;    ///< factor on the body
  double step_m = 0;  ///< the person is elsewhere in every second frame
  int frames = 25;
  Vector2d origin_m = {0, 0};
  bool nan = false;
};

constexpr double kAhead_m = 0.02;  ///< trunk of somebody who walks, before the feet

geometry::Pinhole walker_view() { return {{160, 128}, 125, 125, 79.5, 63.5}; }

Trial run(const WalkerScene& scene, std::uint64_t seed, Residuals&) {
  RandomGeometry random(seed);
  geometry::Pose camera = plan::people_camera();
  camera.translation_m.head<2>() += scene.origin_m;
  plan::StandingBody body;
  body.yaw_rad = random.uniform(0, 2 * M_PI);
  body.height_m = scene.size * random.uniform(1.55, 1.9);
  body.half_width_m = scene.size * random.uniform(0.19, 0.25);
  body.half_depth_m = scene.size * random.uniform(0.11, 0.15);
  const double side = random.uniform(-0.5, 0.5);
  plan::PeopleTracker tracker;
  estimation::Estimate<Vector2d> estimate;
  Vector2d truth;
  const auto follow = [&] {
    estimation::Estimate<Vector2d> of;
    of.verdict = estimation::Verdict::degenerate("nobody, or more than one, is followed");
    for (int i = 0; i < scene.frames; ++i) {
      const double jump = i % 2 == 0 ? 0 : scene.step_m;
      truth = scene.origin_m +
              Vector2d(scene.away_m, side + jump + scene.speed_m_s * (i / scene.rate_hz - 0.5));
      body.x_m = truth.x(), body.y_m = truth.y() + kAhead_m * std::min(1.0, scene.speed_m_s);
      Image<float> depth = plan::draw_people({body}, walker_view(), camera);
      for (int y = 0; y < depth.height(); ++y)
        for (int x = 0; x < depth.width(); ++x)
          if (depth.at(x, y) > 0)
            depth.at(x, y) += static_cast<float>(scene.nan ? NAN : scene.sigma_m * random.normal());
      const auto people = tracker.add({depth, walker_view(), camera, depth}, i / scene.rate_hz);
      if (i + 1 < scene.frames || people.size() != 1) continue;
      of.value = people[0].on_floor_m, of.covariance = people[0].covariance;
      of.verdict = estimation::Verdict::ok();
    }
    return of;
  };
  Trial trial = timed(follow, estimate);
  if (estimate.usable()) trial.error = estimate.value - truth;
  return trial;
}

}  // namespace

void add_people_cases(std::vector<Case>& cases) {
  const auto add = case_adder<WalkerScene>(cases, "PeopleTracker", run);
  add("stands", Expect::kRobust, {});
  add("walks", Expect::kRobust, {.speed_m_s = 1});
  add("walks fast", Expect::kRobust, {.speed_m_s = 2});
  add("10 Hz", Expect::kRobust, {.speed_m_s = 1, .rate_hz = 10, .frames = 15});
  add("60 Hz", Expect::kRobust, {.speed_m_s = 1, .rate_hz = 60, .frames = 60});
  add("without noise", Expect::kRobust, {.sigma_m = 0});
  add("3 cm of noise", Expect::kRobust, {.sigma_m = 0.03});
  add("a child", Expect::kRobust, {.size = 0.75});
  add("5.5 m away", Expect::kRobust, {.away_m = 5.5});
  add("1 km from the origin", Expect::kRobust, {.speed_m_s = 1, .origin_m = {1e3, -1e3}});
  add("two frames", Expect::kRefusal, {.frames = 2});
  add("a doll", Expect::kRefusal, {.size = 0.15});
  add("20 m away", Expect::kRefusal, {.away_m = 20});
  add("not a number", Expect::kRefusal, {.nan = true});
  add("here and there", Expect::kCareful, {.step_m = 1.5});
  for (const double away : {2.5, 4.0, 6.0, 8.0, 10.0})
    add("away " + shown(away), Expect::kCareful, {.away_m = away}, "distance, m", away);
}

}  // namespace mixrig::estimation_bench

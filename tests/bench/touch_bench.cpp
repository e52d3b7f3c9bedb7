// SPDX-License-Identifier: Apache-2.0
// Time of a frame in which people stand in objects, by picture size, people and objects; and time
// of the physics of a frame with objects that are pushed.
#include <array>
#include <cstdlib>

#include <benchmark/benchmark.h>

#include "extras/people/plan/people_tracker.h"
#include "extras/people/touch/physics.h"
#include "extras/people/touch/touch_watch.h"
#include "tests/unit/plan/standing_people.h"
#include "tests/unit/touch/touch_shapes.h"

namespace mixrig::touch {
namespace {

geometry::Pinhole view_of_width(int width, int height) {
  const geometry::Pinhole view = plan::people_view();
  const double scale = static_cast<double>(width) / view.size_px.width;
  return {{width, height},
          view.fx_px * scale,
          view.fy_px * scale,
          0.5 * width - 0.5,
          0.5 * height - 0.5};
}

/// range(2): number of objects; 0: tracking alone; negative: balls, whose hull has 500 faces,
/// instead of boxes.
void touch_people(benchmark::State& state) {
  const int width = static_cast<int>(state.range(0)), count = static_cast<int>(state.range(1));
  const auto objects = static_cast<std::size_t>(std::abs(state.range(2)));
  const geometry::Pinhole view = view_of_width(width, width == 512 ? 424 : width * 4 / 5);
  std::vector<plan::StandingBody> people;
  for (int i = 0; i < count; ++i) people.push_back({2.6 + 0.5 * (i % 2), 0.7 * i - 0.35 * count});
  const Image<float> depth_m = plan::draw_people(people, view);
  plan::PeopleTracker tracker;
  const TestMesh mesh = ball_mesh(0.4F);
  std::vector<geometry::Pose> poses;
  for (std::size_t i = 0; i < objects; ++i) {
    const auto& body = people[i % people.size()];
    poses.push_back({Eigen::Quaterniond::Identity(), {body.x_m, body.y_m - 0.3, 1}});
  }
  const Eigen::Vector3f half(0.4F, 0.4F, 0.4F);
  TouchWatch watch(std::vector<Shape>(objects, state.range(2) < 0
                                                   ? make_shape(std::array{mesh.triangles()}, 1)
                                                   : box_shape({-half, half})));
  double time_s = 0;
  std::size_t events = 0;
  for (auto _ : state) {
    const plan::SegmentedView seen{depth_m, view, plan::people_camera(), depth_m};
    const auto followed = tracker.add(seen, time_s);
    events += watch.add({seen, followed, poses, {}, time_s}).size();
    time_s += 0.04;
  }
  state.counters["events"] = static_cast<double>(events);
}
BENCHMARK(touch_people)
    ->ArgsProduct({{320, 512, 1280}, {1, 3}, {0, 1, 3, -1, -3}})
    ->Unit(benchmark::kMillisecond);

void physics(benchmark::State& state) {
  Physics physics;
  const TestMesh mesh = ball_mesh(0.11F);
  const Shape ball = make_shape(std::array{mesh.triangles()}, 1);
  const Body body{.mass_kg = 0.4, .is_ball = true};
  for (int i = 0; i < state.range(0); ++i)
    physics.add(ball, {Eigen::Quaterniond::Identity(), {0.3 * i, 0, 0.11}}, &body);
  std::vector<Pusher> pushers(100);
  double time_s = 0;
  for (auto _ : state) {
    for (std::size_t i = 0; i < pushers.size(); ++i)
      pushers[i].at_m = {0.03F * static_cast<float>(i), 0.15F, 0.1F};
    physics.set_pushers(pushers);
    physics.advance(time_s);
    time_s += 0.04;
  }
}
BENCHMARK(physics)->Arg(1)->Arg(5)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mixrig::touch

BENCHMARK_MAIN();

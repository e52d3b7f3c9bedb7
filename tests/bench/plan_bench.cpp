// SPDX-License-Identifier: Apache-2.0
// Time of following people in one frame, by picture size and number of people.
#include <benchmark/benchmark.h>

#include "extras/people/plan/people_tracker.h"
#include "tests/unit/plan/standing_people.h"

namespace mixrig::plan {
namespace {

void follow(benchmark::State& state) {
  const int width = static_cast<int>(state.range(0)), count = static_cast<int>(state.range(1));
  geometry::Pinhole view = people_view();
  const double scale = static_cast<double>(width) / view.size_px.width;
  view = {{width, width * 4 / 5},
          view.fx_px * scale,
          view.fy_px * scale,
          (view.cx_px + 0.5) * scale - 0.5,
          (view.cy_px + 0.5) * scale - 0.5};
  std::vector<StandingBody> people;
  for (int i = 0; i < count; ++i) people.push_back({2.6 + 0.5 * (i % 2), 0.7 * i - 0.35 * count});
  const Image<float> depth_m = draw_people(people, view);
  PeopleTracker tracker;
  double time_s = 0;
  std::size_t followed = 0;
  for (auto _ : state) {
    followed = tracker.add({depth_m, view, people_camera(), depth_m}, time_s).size();
    time_s += 0.04;
  }
  state.counters["followed"] = static_cast<double>(followed);
}
BENCHMARK(follow)->ArgsProduct({{320, 512, 1280}, {1, 3}})->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mixrig::plan

BENCHMARK_MAIN();

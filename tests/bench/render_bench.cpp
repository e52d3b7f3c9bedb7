// SPDX-License-Identifier: Apache-2.0
// Frames of the cpu back end, milliseconds a stage as counters. Run on an idle machine:
//   render_bench --benchmark_repetitions=5
// heap_mb: what the compositor and the images of a frame hold. moved_mb: bytes that a still frame
// reads and writes at least, each image once in each pass that needs all of it; copy_ms: the time
// in which one thread of this machine copies so many. Of a build with MIXRIG_CPU_LEVELS the
// environment's MIXRIG_CPU_LEVEL, as "x86-64-v3", is the highest level that runs.
#include <cstdlib>
#include <string>

#include <benchmark/benchmark.h>

#include "host/judge/bench/copy_rate.h"
#include "host/judge/bench/heap.h"
#include "host/judge/bench/moved_bytes.h"
#include "host/render/cpu/compositor_cpu.h"
#include "tests/bench/statue_room.h"

namespace mixrig::test {
namespace {

constexpr Size kKinect2{512, 424}, kSr3000{176, 144}, kXga{1280, 1024}, kFullHd{1920, 1080};

double heap_mb() { return 1e-6 * bench::heap_bytes(); }

double copy_mb_per_ms() {
  static const double rate = 1e-9 * bench::copy_bytes_per_s();
  return rate;
}

/// range(0): threads. range(1): 0 still; 1 the camera moves, so that nothing is kept between
/// frames; 2 the background is also drawn for each pose; 3 the lens moves instead of the camera.
template <typename Room>
void compose_in(benchmark::State& state, Size view, Size tof, bool second_tof = false) {
  Room room({.view = view, .tof = tof, .lens_k1 = -0.05, .second_tof = second_tof});
  if (state.range(1) >= 2) room.draw_background_for_each_pose();
  const bool zooms = state.range(1) == 3;
  room.setup.lens_moves = zooms;
  const double before_mb = heap_mb();
  const char* level = std::getenv("MIXRIG_CPU_LEVEL");
  auto compositor = render::make_cpu_compositor(room.setup, static_cast<int>(state.range(0)),
                                                level != nullptr ? level : "");
  if (!compositor) {
    state.SkipWithError(compositor.error().context.c_str());
    return;
  }
  state.SetLabel((*compositor)->state().renderer);
  render::FrameOutput output;
  render::FrameInput frame = room.frame();
  if (zooms) frame.lens = geometry::LensState{room.setup.target, 0};
  // The images of both frames in flight are allocated and the shadow maps drawn before the timing
  // starts.
  for (int i = 0; i < 2; ++i)
    if (!(*compositor)->compose(frame, output)) state.SkipWithError("compose failed");
  state.counters["heap_mb"] = heap_mb() - before_mb;
  if (state.range(1) == 0) {
    const double mb = 1e-6 * bench::moved_bytes(view, tof);
    state.counters["moved_mb"] = mb;
    state.counters["copy_ms"] = mb / copy_mb_per_ms();
  }
  render::StageTimes sum{};
  for (auto _ : state) {
    if (zooms)
      frame.lens->camera.pinhole.fx_px *= 1.0001;
    else if (state.range(1))
      frame.world_from_target.translation_m.x() += 1e-4;
    if (!(*compositor)->compose(frame, output)) state.SkipWithError("compose failed");
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += (*compositor)->state().stage_times[i];
  }
  for (std::size_t i = 0; i < sum.size(); ++i)
    state.counters[std::string(render::name(static_cast<render::Stage>(i))) + "_ms"] =
        benchmark::Counter(sum[i], benchmark::Counter::kAvgIterations);
}

void compose(benchmark::State& state, Size view, Size tof) {
  compose_in<RoomSetup>(state, view, tof);
}
void two_depth_cameras(benchmark::State& state, Size view, Size tof) {
  compose_in<RoomSetup>(state, view, tof, true);
}
void statue(benchmark::State& state, Size view, Size tof) {
  compose_in<StatueRoom>(state, view, tof);
}

void arguments(benchmark::internal::Benchmark* bench) {
  bench->Args({1, 0})->Args({2, 0})->Args({2, 1})->Args({2, 2})->Args({2, 3})->ArgNames(
      {"threads", "moving"});
  bench->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();
}

BENCHMARK_CAPTURE(compose, kinect2_1280x1024, kXga, kKinect2)->Apply(arguments);
BENCHMARK_CAPTURE(two_depth_cameras, kinect2_1280x1024, kXga, kKinect2)->Apply(arguments);
BENCHMARK_CAPTURE(statue, kinect2_1280x1024, kXga, kKinect2)->Apply(arguments);
BENCHMARK_CAPTURE(compose, sr3000_1280x1024, kXga, kSr3000)->Apply(arguments);
BENCHMARK_CAPTURE(compose, kinect2_1920x1080, kFullHd, kKinect2)->Apply(arguments);

}  // namespace
}  // namespace mixrig::test

BENCHMARK_MAIN();

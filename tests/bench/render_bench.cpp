// SPDX-License-Identifier: Apache-2.0
// Frames of the cpu back end, milliseconds a stage as counters. Run on an idle machine:
//   render_bench --benchmark_repetitions=5
// heap_mb: what the compositor and the images of a frame hold. moved_mb: bytes that a still frame
// reads and writes at least, each image once in each pass that needs all of it; copy_ms: the time
// in which one thread of this machine copies so many.
#include <algorithm>
#include <chrono>
#include <cstring>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <malloc.h>

#include "host/render/cpu/compositor_cpu.h"
#include "tests/bench/statue_room.h"

namespace mixrig::test {
namespace {

constexpr Size kKinect2{512, 424}, kSr3000{176, 144}, kXga{1280, 1024}, kFullHd{1920, 1080};

double heap_mb() {
  const struct mallinfo2 info = mallinfo2();
  return 1e-6 * static_cast<double>(info.uordblks + info.hblkhd);
}

/// Read and written by a thread that copies what no cache holds, megabytes a millisecond.
double copy_mb_per_ms() {
  static const double rate = [] {
    constexpr std::size_t kBytes = 256U << 20U;
    std::vector<char> from(kBytes, 1), to(kBytes, 2);
    double best_ms = 1e9;
    for (int i = 0; i < 5; ++i) {
      const auto start = std::chrono::steady_clock::now();
      std::memcpy(to.data(), from.data(), kBytes);
      benchmark::DoNotOptimize(to.data());
      const std::chrono::duration<double, std::milli> ms = std::chrono::steady_clock::now() - start;
      best_ms = std::min(best_ms, ms.count());
    }
    return 2e-6 * static_cast<double>(kBytes) / best_ms;
  }();
  return rate;
}

/// Of a still frame with all images of kComposite: bytes a view pixel and a ToF pixel.
double moved_mb(Size view, Size tof) {
  constexpr double kPlate = 3 + 8 + 8 + 3;        // sRGB, tap; linear light, sRGB
  constexpr double kWarp = 4 + 4;                 // cleared, drawn
  constexpr double kKey = 4 + 4 + 1 + 1 + 1;      // w, limit; state; state; matte
  constexpr double kLight = 1 + 4 + 1 + 2 + 2;    // matte, w; matte, light; light
  constexpr double kMix = 4 + 4 + 1 + 4 + 4 + 2;  // w, learned, matte; two depths; light
  constexpr double kCorrect = 4 + 8 + 4 + 4 + 4 + 8 + 8 + 8 + 5;  // five sweeps
  constexpr double kProject = 8 + 4 + 12 + 8;                     // ray, w; u, v, w; u and w again
  const auto mega = [](Size size) { return 1e-6 * static_cast<double>(size.area()); };
  return mega(view) * (kPlate + kWarp + kKey + kLight + kMix) + mega(tof) * (kCorrect + kProject);
}

/// range(0): threads; range(1): 1 where the camera moves, so that nothing is kept between frames, 2
/// where the background is drawn for each pose too, 3 where instead of the camera its lens moves.
template <typename Room>
void compose_in(benchmark::State& state, Size view, Size tof, bool second_tof = false) {
  Room room({.view = view, .tof = tof, .lens_k1 = -0.05, .second_tof = second_tof});
  if (state.range(1) >= 2) room.draw_background_for_each_pose();
  const bool zooms = state.range(1) == 3;
  room.setup.lens_moves = zooms;
  const double before_mb = heap_mb();
  auto compositor = render::make_cpu_compositor(room.setup, static_cast<int>(state.range(0)));
  if (!compositor) {
    state.SkipWithError(compositor.error().context.c_str());
    return;
  }
  render::FrameOutput output;
  render::FrameInput frame = room.frame();
  if (zooms) frame.lens = render::FrameLens{room.setup.target, 0};
  // Images of both frames in flight grow, and shadow maps are drawn, before the time is taken.
  for (int i = 0; i < 2; ++i)
    if (!(*compositor)->compose(frame, output)) state.SkipWithError("compose failed");
  state.counters["heap_mb"] = heap_mb() - before_mb;
  if (state.range(1) == 0) {
    const double mb = moved_mb(view, tof);
    state.counters["moved_mb"] = mb;
    state.counters["copy_ms"] = mb / copy_mb_per_ms();
  }
  render::StageTimes sum{};
  for (auto _ : state) {
    if (zooms)
      frame.lens->target.pinhole.fx_px *= 1.0001;
    else if (state.range(1))
      frame.world_from_target.translation_m.x() += 1e-4;
    if (!(*compositor)->compose(frame, output)) state.SkipWithError("compose failed");
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += (*compositor)->stage_times()[i];
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

// SPDX-License-Identifier: Apache-2.0
// Milliseconds per stage of both back ends at 1280 x 1024 with a 512 x 424 ToF camera, the least of
// some frames. Every second frame moves the camera, so that each stage runs.
#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>

#include "host/render/cpu/compositor_cpu.h"
#include "host/render/gles/compositor_gles.h"
#include "tests/gl/room_setup.h"

namespace {

using namespace mixrig;

constexpr int kFrames = 12;

struct Least {
  render::StageTimes moved, still;
};

Least measure(render::Compositor& compositor, const test::RoomSetup& room) {
  Least least;
  least.moved.fill(1e9F);
  least.still.fill(1e9F);
  render::FrameOutput output;
  render::FrameInput frame = room.frame();
  for (int i = 0; i < kFrames; ++i) {
    if (i % 2 == 0) frame.world_from_target.translation_m.x() = 0.001 * i;
    if (!compositor.compose(frame, output)) return least;
    render::StageTimes& to = i % 2 == 0 ? least.moved : least.still;
    for (std::size_t s = 0; s < to.size(); ++s)
      to[s] = std::min(to[s], compositor.state().stage_times[s]);
  }
  return least;
}

void print(const char* name, const render::StageTimes& times) {
  std::printf("%-14s", name);
  float sum = 0;
  for (const float ms : times) std::printf("%9.2f", ms), sum += ms;
  std::printf("%9.2f\n", sum);
}

}  // namespace

int main() {
  const test::RoomSetup room({.view = {1280, 1024}, .tof = {512, 424}, .lens_k1 = -0.05});
  auto cpu = render::make_cpu_compositor(room.setup, 0);
  auto gles = render::make_gles_compositor(room.setup);
  if (!cpu || !gles) {
    std::fprintf(stderr, "%s\n", (cpu ? gles.error() : cpu.error()).context.c_str());
    return 1;
  }
  std::printf("%s\n%s\n%-14s", (*cpu)->state().renderer.c_str(), (*gles)->state().renderer.c_str(),
              "ms");
  for (std::size_t s = 0; s < std::size(render::StageTimes{}); ++s)
    std::printf("%9s", std::string(render::name(static_cast<render::Stage>(s))).c_str());
  std::printf("%9s\n", "sum");
  for (const auto& [name, compositor] : {std::pair{"cpu", cpu->get()}, {"gles", gles->get()}}) {
    const Least least = measure(*compositor, room);
    print((std::string(name) + ", moving").c_str(), least.moved);
    print((std::string(name) + ", still").c_str(), least.still);
  }
  return 0;
}

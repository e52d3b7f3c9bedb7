// SPDX-License-Identifier: Apache-2.0
// Chooses among the processor levels that this program contains.
#include "host/render/cpu/back_end.h"
#include "host/render/cpu/compositor_cpu.h"

namespace mixrig::render {
namespace {

const CpuBackEnd& back_end([[maybe_unused]] std::string_view most) {
#ifdef MIXRIG_CPU_LEVELS
  const auto may_be = [&](std::string_view level, const CpuBackEnd& b) {
    return (most.empty() || level <= most) && b.layout == door_layout();
  };
  const CpuBackEnd &v4 = mixrig_cpu_x86_64_v4, &v3 = mixrig_cpu_x86_64_v3;
  if (__builtin_cpu_supports("x86-64-v4") && may_be("x86-64-v4", v4)) return v4;
  if (__builtin_cpu_supports("x86-64-v3") && may_be("x86-64-v3", v3)) return v3;
#endif
  return mixrig_cpu;
}

}  // namespace

std::string cpu_vectors(std::string_view most) { return back_end(most).vectors(); }

Result<std::unique_ptr<Compositor>> make_cpu_compositor(const CompositorSetup& setup, int threads,
                                                        std::string_view most) {
  return back_end(most).make(setup, threads);
}

}  // namespace mixrig::render

// SPDX-License-Identifier: Apache-2.0
// Which of the levels that this program holds is used on this processor.
#include "host/render/cpu/back_end.h"
#include "host/render/cpu/compositor_cpu.h"

namespace mixrig::render {
namespace {

const CpuBackEnd& back_end([[maybe_unused]] std::string_view most) {
#ifdef MIXRIG_CPU_LEVELS
  const auto may_be = [&](std::string_view level) { return most.empty() || level <= most; };
  if (may_be("x86-64-v4") && __builtin_cpu_supports("x86-64-v4")) return mixrig_cpu_x86_64_v4;
  if (may_be("x86-64-v3") && __builtin_cpu_supports("x86-64-v3")) return mixrig_cpu_x86_64_v3;
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

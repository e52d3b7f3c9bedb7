// SPDX-License-Identifier: Apache-2.0
// The one door between this room's code, compiled for one level of the processor, and all else.
#pragma once

#include <memory>
#include <string>

#include "host/render/compositor.h"

namespace mixrig::render {

/// The room compiled for one level.
struct CpuBackEnd {
  Result<std::unique_ptr<Compositor>> (*make)(const CompositorSetup&, int threads);
  std::string (*vectors)();  ///< as cpu_vectors()
};

}  // namespace mixrig::render

#ifndef MIXRIG_CPU_BACK_END
#define MIXRIG_CPU_BACK_END mixrig_cpu
#endif

// Without names of C++, so that the link step of a level can name what it keeps (MixrigCpuLevels).
extern "C" {
extern const mixrig::render::CpuBackEnd MIXRIG_CPU_BACK_END;  ///< for the level of the build
#ifdef MIXRIG_CPU_LEVELS
extern const mixrig::render::CpuBackEnd mixrig_cpu_x86_64_v3, mixrig_cpu_x86_64_v4;
#endif
}

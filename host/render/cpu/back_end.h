// SPDX-License-Identifier: Apache-2.0
// The only interface between this module's code, compiled for one processor level, and its callers.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "host/render/contract/compositor.h"

namespace mixrig::render {

/// A number that differs if a level's compiler lays out the types of this interface differently.
constexpr std::size_t door_layout() {
  std::size_t layout = 0;
  for (const std::size_t n :
       {sizeof(CompositorSetup), alignof(CompositorSetup), sizeof(FrameInput), alignof(FrameInput),
        sizeof(VirtualObject), sizeof(FrameOutput), sizeof(BackgroundModel),
        sizeof(CompositorState), sizeof(geometry::Lamp)})
    layout = 1009 * layout + n;
  return layout;
}

/// The back end as compiled for one processor level.
struct CpuBackEnd {
  std::size_t layout;  ///< door_layout()
  Result<std::unique_ptr<Compositor>> (*make)(const CompositorSetup&, int threads);
  std::string (*vectors)();  ///< the function cpu_vectors()
};

}  // namespace mixrig::render

#ifndef MIXRIG_CPU_BACK_END
#define MIXRIG_CPU_BACK_END mixrig_cpu
#endif

// C linkage, so that the link step of a level can name the symbols that it keeps (MixrigCpuLevels).
extern "C" {
/// Compiled for the level of the build.
extern const mixrig::render::CpuBackEnd MIXRIG_CPU_BACK_END;
#ifdef MIXRIG_CPU_LEVELS
extern const mixrig::render::CpuBackEnd mixrig_cpu_x86_64_v3, mixrig_cpu_x86_64_v4;
#endif
}

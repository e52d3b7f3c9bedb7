// SPDX-License-Identifier: Apache-2.0
// The compositor on OpenGL ES 3.1.
#pragma once

#include <memory>
#include <string_view>

#include "host/render/contract/compositor.h"

namespace mixrig::render {

/// Which drivers read plates in their camera's memory (FrameInput::shared), where they offer it.
enum class PlateImport {
  kOnGpu,   ///< not one that draws on the processor: nothing is gained there, and Mesa's ends the
            ///< process where it reads a buffer that another device made
  kAlways,  ///< for buffers that the driver's own device made
};

/// Makes a context of its own, which is left current on no thread: the compositor stays on that of
/// its first frame, which may be another one than this.
/// Borrows meshes, textures and background of `setup` during the call only. Errors: kData from
/// validate(setup); kDevice without EGL; kUnsupported where the driver cannot draw the passes.
Result<std::unique_ptr<Compositor>> make_gles_compositor(const CompositorSetup& setup,
                                                         const GlShare& share = {},
                                                         PlateImport import = PlateImport::kOnGpu);

}  // namespace mixrig::render

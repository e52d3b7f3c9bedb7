// SPDX-License-Identifier: Apache-2.0
// Makes the compositor on OpenGL ES 3.1.
#pragma once

#include <memory>
#include <string_view>

#include "host/render/contract/compositor.h"

namespace mixrig::render {

/// Which drivers may read plates in the camera's memory (FrameInput::shared), if they offer it.
enum class PlateImport {
  kOnGpu,   ///< only drivers of a GPU: software gains nothing, and Mesa's ends the process when it
            ///< reads a buffer that another device made
  kAlways,  ///< any driver, for buffers that its own device made
};

/// Makes a compositor with its own GL context, current in no thread afterwards: the compositor
/// belongs to the thread of its first frame, which may differ from this one. Meshes, textures and
/// background of `setup` are borrowed during the call only. Errors: kData from validate(setup);
/// kDevice without EGL; kUnsupported where the driver cannot draw the passes.
Result<std::unique_ptr<Compositor>> make_gles_compositor(const CompositorSetup& setup,
                                                         const GlShare& share = {},
                                                         PlateImport import = PlateImport::kOnGpu);

}  // namespace mixrig::render

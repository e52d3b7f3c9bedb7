// SPDX-License-Identifier: Apache-2.0
// The compositor on plain cores: the tests' reference, and what runs where there is no GPU.
#pragma once

#include <memory>

#include "host/render/compositor.h"

namespace mixrig::render {

/// `threads` >= 1; 0 means one per core. Borrows meshes, textures and background of `setup`.
/// Errors: kData, from validate(setup).
Result<std::unique_ptr<Compositor>> make_cpu_compositor(const CompositorSetup& setup, int threads);

}  // namespace mixrig::render

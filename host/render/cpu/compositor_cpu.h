// SPDX-License-Identifier: Apache-2.0
// The compositor on plain cores: the tests' reference, and what runs where there is no GPU.
#pragma once

#include <memory>
#include <string>

#include "host/render/compositor.h"

namespace mixrig::render {

/// `threads` >= 1; 0 means one per core. Borrows meshes, textures and background of `setup`.
/// Errors: kData, from validate(setup).
Result<std::unique_ptr<Compositor>> make_cpu_compositor(const CompositorSetup& setup, int threads);

/// Level of the processor that this back end is compiled for and the vectors that it works with:
/// "x86-64-v3 (AVX2, 8 lanes)".
std::string cpu_vectors();

}  // namespace mixrig::render

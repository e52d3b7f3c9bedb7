// SPDX-License-Identifier: Apache-2.0
// Makes the compositor on plain cores: the tests' reference, used where there is no GPU.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "host/render/contract/compositor.h"

namespace mixrig::render {

/// `threads` >= 1; 0 means one a core. Borrows meshes, textures and background of `setup`. Uses the
/// highest processor level built into the program (MIXRIG_CPU_LEVELS) that this machine supports,
/// but none above `most` (such as "x86-64-v3") unless that is empty. Errors: kData from
/// validate(setup).
Result<std::unique_ptr<Compositor>> make_cpu_compositor(const CompositorSetup& setup, int threads,
                                                        std::string_view most = {});

/// The level in use and its vectors, such as "x86-64-v3 (AVX2, 8 lanes)".
std::string cpu_vectors(std::string_view most = {});

}  // namespace mixrig::render

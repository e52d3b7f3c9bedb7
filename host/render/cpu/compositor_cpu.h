// SPDX-License-Identifier: Apache-2.0
// The compositor on plain cores: the tests' reference, and what runs where there is no GPU.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "host/render/contract/compositor.h"

namespace mixrig::render {

/// `threads` >= 1; 0 means one per core. Borrows meshes, textures and background of `setup`.
/// Of the levels of the processor that the program holds (MIXRIG_CPU_LEVELS) the highest one runs
/// that this machine has, but none above `most` (as "x86-64-v3"), unless that is empty.
/// Errors: kData, from validate(setup).
Result<std::unique_ptr<Compositor>> make_cpu_compositor(const CompositorSetup& setup, int threads,
                                                        std::string_view most = {});

/// The level that runs and the vectors that it works with: "x86-64-v3 (AVX2, 8 lanes)".
std::string cpu_vectors(std::string_view most = {});

}  // namespace mixrig::render

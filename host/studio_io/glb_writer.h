// SPDX-License-Identifier: Apache-2.0
// The studio's object as a binary glTF 2.0 file.
#pragma once

#include <filesystem>

#include "hal/base/result.h"
#include "host/studio/studio.h"

namespace mixrig::studio_io {

/// Writes meshes and textures (embedded PNG) of `object` in glTF's axes, y up. The folder must
/// exist. Errors: kIo.
Result<void> write_glb(const studio::VirtualObject& object, const std::filesystem::path& path);

}  // namespace mixrig::studio_io

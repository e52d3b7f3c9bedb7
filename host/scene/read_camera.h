// SPDX-License-Identifier: Apache-2.0
// The table [camera] of scene.toml. Private to this module.
#pragma once

#include <filesystem>

#include "host/math/config/table.h"
#include "host/scene/scene.h"

namespace mixrig::scene {

/// Fills pose_source, camera and capture_volume of `scene`. Errors are noted in the document.
/// Relative paths start at `folder`.
void read_camera(const config::Table& table, const std::filesystem::path& folder, Scene& scene);

}  // namespace mixrig::scene

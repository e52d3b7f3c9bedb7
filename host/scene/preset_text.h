// SPDX-License-Identifier: Apache-2.0
// Presets of a scene: the tables of its objects, light, focus and look, as text, and what differs
// between two scenes in them. Pure.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/result.h"
#include "host/scene/scene.h"

namespace mixrig::scene {

/// Returns the tables [[object]], [light], [[light.lamp]], [focus] and [look] of a scene's text,
/// with the comments before them.
std::string preset_of(std::string_view scene_text);
/// Returns the scene's text with the preset's tables in place of its own. `path` is the scene's
/// path, to which paths in the preset are relative. Errors: kFormat where the result is no scene,
/// or the preset has other tables.
Result<std::string> with_preset(std::string_view scene_text, std::string_view preset,
                                const std::filesystem::path& path);

/// One line for each object, lamp, focus or other light of `there` that is otherwise in `here`,
/// such as "crate: moved by 0.42 m", at most 20. Models are not compared.
std::vector<std::string> differences(const Scene& here, const Scene& there);

}  // namespace mixrig::scene

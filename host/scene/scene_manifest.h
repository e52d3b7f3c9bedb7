// SPDX-License-Identifier: Apache-2.0
// scene.toml without the models that it names. Private to this module.
#pragma once

#include <filesystem>
#include <string_view>

#include "hal/base/result.h"
#include "host/scene/scene.h"

namespace mixrig::scene {

/// Parses the text of a scene whose path is `path`. With `load_models` the models are read too.
/// Errors: kFormat (file:line: key ...).
Result<Scene> parse_scene(std::string_view text, const std::filesystem::path& path,
                          bool load_models);

}  // namespace mixrig::scene

// SPDX-License-Identifier: Apache-2.0
// Loads scenes.
#include "host/scene/scene.h"

#include "host/math/config/table.h"
#include "host/scene/scene_manifest.h"

namespace mixrig::scene {

Result<Scene> load_scene(const std::filesystem::path& path) {
  constexpr std::size_t kMaxBytes = std::size_t{1} << 20;
  MIXRIG_ASSIGN(const std::string text, config::read_text(path, kMaxBytes));
  return parse_scene(text, path, true);
}

}  // namespace mixrig::scene

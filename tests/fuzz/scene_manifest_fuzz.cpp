// SPDX-License-Identifier: Apache-2.0
// Any bytes as scene.toml, without the models that it names.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "host/scene/scene_manifest.h"
#include "tests/fuzz/target.h"

MIXRIG_FUZZ_TARGET(scene_manifest) {
  using namespace mixrig;
  const auto scene =
      scene::parse_scene({reinterpret_cast<const char*>(data), size}, "scene.toml", false);
  if (!scene && scene.error().context.find('\n') != std::string::npos) std::abort();
  return 0;
}

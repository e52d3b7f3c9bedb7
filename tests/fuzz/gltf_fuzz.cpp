// SPDX-License-Identifier: Apache-2.0
// Any bytes as glTF models. An accepted model must be consistent.
#include <cstdint>
#include <cstdlib>

#include "host/scene/gltf/gltf_model.h"
#include "tests/fuzz/target.h"

MIXRIG_FUZZ_TARGET(gltf) {
  using namespace mixrig;
  const auto model = scene::parse_model({data, size}, "/nonexistent");
  if (!model) return 0;
  for (const scene::Mesh& mesh : model->meshes) {
    if (mesh.normals.size() != mesh.positions_m.size() || mesh.indices.size() % 3 != 0)
      std::abort();
    for (const std::uint32_t index : mesh.indices)
      if (index >= mesh.positions_m.size()) std::abort();
    if (mesh.texture >= static_cast<int>(model->textures.size())) std::abort();
  }
  return 0;
}

// SPDX-License-Identifier: Apache-2.0
// Converts a scene to the types of the compositor.
#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "hal/base/image.h"
#include "host/render/contract/compositor.h"
#include "host/scene/scene.h"

namespace mixrig::session {

/// A mesh of the scene in the types of the back ends.
struct MeshArrays {
  std::vector<glm::vec3> positions_m, normals;
  std::vector<glm::vec2> uv;
};

/// Meshes of the scene's objects, then of the set's model; hidden objects are included.
std::vector<MeshArrays> mesh_arrays(const scene::Scene& scene);

/// Sets objects, light, key and focus of `setup`, whose view must be set; it borrows `scene` and
/// `meshes`. Hidden objects get no mesh, so that the others keep their indices. Precondition:
/// mesh_arrays(scene) made `meshes`.
void set_scene(const scene::Scene& scene, const std::vector<MeshArrays>& meshes,
               render::CompositorSetup& setup);

}  // namespace mixrig::session

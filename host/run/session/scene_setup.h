// SPDX-License-Identifier: Apache-2.0
// A scene in the types of the compositor.
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

/// Of the scene's objects, then of the set's model; of hidden objects too.
std::vector<MeshArrays> mesh_arrays(const scene::Scene& scene);

/// Sets objects, light, key and focus of `setup`, whose view is known; it borrows scene and meshes.
/// Hidden objects have no mesh
/// there, so that the others keep their numbers. Precondition: mesh_arrays(scene) made `meshes`.
void set_scene(const scene::Scene& scene, const std::vector<MeshArrays>& meshes,
               render::CompositorSetup& setup);

}  // namespace mixrig::session

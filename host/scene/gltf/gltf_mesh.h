// SPDX-License-Identifier: Apache-2.0
// Reads a glTF primitive as a Mesh. Private to this module.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "host/scene/gltf/gltf_file.h"
#include "host/scene/scene.h"

namespace mixrig::scene {

/// How a node places the vertices of its mesh.
struct Placement {
  Eigen::Matrix4d world = Eigen::Matrix4d::Identity();   ///< glTF axes, affine
  const std::vector<Eigen::Matrix4d>* joints = nullptr;  ///< matrices of its skin; null: none
  std::vector<double> morph_weights;                     ///< one a morph target, or none
};

/// Reads the triangles of a primitive, shaped by its morph targets, then by its joints, then moved
/// by `placement.world` and into object axes. The caller sets material and texture; `uv_set` is the
/// n of TEXCOORD_n, -1 for none. Errors: kFormat for points and lines, indices out of range, and
/// invalid accessors.
Result<Mesh> read_mesh(const tinygltf::Model& gltf, const tinygltf::Primitive& primitive,
                       const Placement& placement, int uv_set);

}  // namespace mixrig::scene

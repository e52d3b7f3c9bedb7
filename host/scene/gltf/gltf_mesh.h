// SPDX-License-Identifier: Apache-2.0
// Reads a glTF primitive as a Mesh. Private to this module.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "host/scene/gltf/gltf_file.h"
#include "host/scene/scene.h"

namespace mixrig::scene {

/// Reads the triangles of a primitive, transformed by `world` (glTF axes, 4x4 affine) and into
/// object axes. `joints`, the matrices of its skin, place its vertices first; null: no skin. The
/// caller sets material and texture; `uv_set` is the n of TEXCOORD_n, -1 for none. Errors: kFormat
/// for points and lines, indices out of range, and invalid accessors.
Result<Mesh> read_mesh(const tinygltf::Model& gltf, const tinygltf::Primitive& primitive,
                       const Eigen::Matrix4d& world, int uv_set,
                       const std::vector<Eigen::Matrix4d>* joints = nullptr);

}  // namespace mixrig::scene

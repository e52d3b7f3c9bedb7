// SPDX-License-Identifier: Apache-2.0
// Skinned meshes at rest (glTF 2.0, 3.7.3.3). Private to this module.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "host/scene/gltf/gltf_file.h"
#include "host/scene/scene.h"

namespace mixrig::scene {

/// Returns a node's own transform: its rotation, translation and scale, or its matrix.
Eigen::Matrix4d local_matrix(const tinygltf::Node& node);

/// Returns scene_from_mesh for each joint of a skin: the joint's place by its nodes times its
/// inverse bind matrix. Errors: kFormat for indices out of range and nodes that are no tree.
Result<std::vector<Eigen::Matrix4d>> joint_matrices(const tinygltf::Model& gltf, int skin);

/// Moves positions and normals to their joints by the primitive's JOINTS_n and WEIGHTS_n.
/// Errors: kFormat for a vertex without weights, joints out of range, and invalid accessors.
Result<void> apply_skin(const tinygltf::Model& gltf, const tinygltf::Primitive& primitive,
                        const std::vector<Eigen::Matrix4d>& joints, Mesh& mesh);

}  // namespace mixrig::scene

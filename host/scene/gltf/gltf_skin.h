// SPDX-License-Identifier: Apache-2.0
// Skinned meshes at rest (glTF 2.0, 3.7.3.3). Private to this module.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "host/scene/gltf/gltf_file.h"
#include "host/scene/scene.h"

namespace mixrig::scene {

/// Rotation, translation and scale of a node, or its matrix.
Eigen::Matrix4d local_matrix(const tinygltf::Node& node);

/// For each joint of a skin, scene from mesh: where the joint stands by its nodes, behind its
/// inverse bind matrix. Errors: kFormat for indices out of range and nodes that are no tree.
Result<std::vector<Eigen::Matrix4d>> joint_matrices(const tinygltf::Model& gltf, int skin);

/// Moves positions and normals to their joints by the primitive's JOINTS_n and WEIGHTS_n.
/// Errors: kFormat for a vertex without weights, joints out of range, and invalid accessors.
Result<void> apply_skin(const tinygltf::Model& gltf, const tinygltf::Primitive& primitive,
                        const std::vector<Eigen::Matrix4d>& joints, Mesh& mesh);

}  // namespace mixrig::scene

// SPDX-License-Identifier: Apache-2.0
#include "host/scene/gltf/gltf_skin.h"

#include <string>

#include <Eigen/Geometry>

#include "host/scene/gltf/gltf_accessor.h"

namespace mixrig::scene {
namespace {

constexpr int kMostLevels = 64;

/// Parent of each node; -1 for roots.
std::vector<int> parents_of(const tinygltf::Model& gltf) {
  std::vector<int> parents(gltf.nodes.size(), -1);
  for (std::size_t i = 0; i < gltf.nodes.size(); ++i)
    for (const int child : gltf.nodes[i].children)
      if (child >= 0 && static_cast<std::size_t>(child) < parents.size())
        parents[static_cast<std::size_t>(child)] = static_cast<int>(i);
  return parents;
}

Result<Eigen::Matrix4d> scene_from_node(const tinygltf::Model& gltf,
                                        const std::vector<int>& parents, int node) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  for (int level = 0; node >= 0; ++level) {
    if (level > kMostLevels) return bad_gltf("its nodes are not a tree of at most 64 levels");
    matrix = local_matrix(gltf.nodes[static_cast<std::size_t>(node)]) * matrix;
    node = parents[static_cast<std::size_t>(node)];
  }
  return matrix;
}

/// Weights of a vertex so far, and the matrix that they make.
struct VertexBlend {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();
  double weight = 0;
};

Result<void> add_influences(const std::vector<Eigen::Vector4f>& numbers,
                            const std::vector<Eigen::Vector4f>& weights,
                            const std::vector<Eigen::Matrix4d>& joints,
                            std::vector<VertexBlend>& blends) {
  if (numbers.size() != blends.size() || weights.size() != blends.size())
    return bad_gltf("the vertex attributes of a primitive differ in length");
  for (std::size_t i = 0; i < blends.size(); ++i)
    for (int k = 0; k < 4; ++k) {
      const double weight = weights[i][k];
      if (weight == 0) continue;
      const auto joint = static_cast<std::size_t>(numbers[i][k]);
      if (joint >= joints.size()) return bad_gltf("a vertex names a joint that its skin lacks");
      blends[i].matrix += weight * joints[joint];
      blends[i].weight += weight;
    }
  return {};
}

}  // namespace

Eigen::Matrix4d local_matrix(const tinygltf::Node& node) {
  if (node.matrix.size() == 16) return Eigen::Map<const Eigen::Matrix4d>(node.matrix.data());
  Eigen::Affine3d local = Eigen::Affine3d::Identity();
  if (const auto& t = node.translation; t.size() == 3)
    local.translate(Eigen::Vector3d(t[0], t[1], t[2]));
  if (const auto& q = node.rotation; q.size() == 4)
    local.rotate(Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized());
  if (const auto& s = node.scale; s.size() == 3) local.scale(Eigen::Vector3d(s[0], s[1], s[2]));
  return local.matrix();
}

Result<std::vector<Eigen::Matrix4d>> joint_matrices(const tinygltf::Model& gltf, int index) {
  if (index < 0 || static_cast<std::size_t>(index) >= gltf.skins.size())
    return bad_gltf("skin " + std::to_string(index) + " does not exist");
  const tinygltf::Skin& skin = gltf.skins[static_cast<std::size_t>(index)];
  std::vector<Eigen::Matrix4d> binds(skin.joints.size(), Eigen::Matrix4d::Identity());
  if (skin.inverseBindMatrices >= 0) {
    MIXRIG_ASSIGN(binds, read_mat4(gltf, skin.inverseBindMatrices));
    if (binds.size() < skin.joints.size())
      return bad_gltf("a skin has fewer inverse bind matrices than joints");
  }
  const std::vector<int> parents = parents_of(gltf);
  std::vector<Eigen::Matrix4d> matrices;
  for (std::size_t j = 0; j < skin.joints.size(); ++j) {
    const int joint = skin.joints[j];
    if (joint < 0 || static_cast<std::size_t>(joint) >= gltf.nodes.size())
      return bad_gltf("a skin names node " + std::to_string(joint) + ", which does not exist");
    MIXRIG_ASSIGN(const Eigen::Matrix4d stands, scene_from_node(gltf, parents, joint));
    matrices.emplace_back(stands * binds[j]);
    if (!matrices.back().allFinite())
      return bad_gltf("a joint of a skin has a transform that is not finite");
  }
  return matrices;
}

Result<void> apply_skin(const tinygltf::Model& gltf, const tinygltf::Primitive& primitive,
                        const std::vector<Eigen::Matrix4d>& joints, Mesh& mesh) {
  std::vector<VertexBlend> blends(mesh.positions_m.size());
  for (int set = 0;; ++set) {
    const auto numbers_at = primitive.attributes.find("JOINTS_" + std::to_string(set));
    const auto weights_at = primitive.attributes.find("WEIGHTS_" + std::to_string(set));
    if (numbers_at == primitive.attributes.end() || weights_at == primitive.attributes.end()) break;
    MIXRIG_ASSIGN(const auto numbers, read_vec4(gltf, numbers_at->second));
    MIXRIG_ASSIGN(const auto weights, read_vec4(gltf, weights_at->second));
    MIXRIG_TRY(add_influences(numbers, weights, joints, blends));
  }
  for (std::size_t i = 0; i < blends.size(); ++i) {
    if (!(blends[i].weight > 1e-6))
      return bad_gltf(
          "has a skin, and a vertex that is bound to no joint: apply the skin before the "
          "export");
    const Eigen::Matrix4d matrix = blends[i].matrix / blends[i].weight;
    const Eigen::Matrix3d linear = matrix.topLeftCorner<3, 3>();
    mesh.positions_m[i] =
        (linear * mesh.positions_m[i].cast<double>() + matrix.topRightCorner<3, 1>()).cast<float>();
    if (mesh.normals.empty()) continue;
    Eigen::Matrix3d cofactors;
    cofactors << linear.col(1).cross(linear.col(2)), linear.col(2).cross(linear.col(0)),
        linear.col(0).cross(linear.col(1));
    mesh.normals[i] = (cofactors * mesh.normals[i].cast<double>()).normalized().cast<float>();
  }
  return {};
}

}  // namespace mixrig::scene

// SPDX-License-Identifier: Apache-2.0
// glTF 2.0, section 3.7: primitives to triangles in object axes.
#include "host/scene/gltf/gltf_mesh.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <string>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "host/scene/gltf/gltf_accessor.h"
#include "host/scene/gltf/gltf_skin.h"

namespace mixrig::scene {
namespace {

int attribute(const tinygltf::Primitive& primitive, const std::string& name) {
  const auto found = primitive.attributes.find(name);
  return found == primitive.attributes.end() ? -1 : found->second;
}

/// Returns the corners of separate triangles of a list, a strip or a fan (glTF 2.0, 3.7.2.1).
Result<std::vector<std::uint32_t>> triangles(const std::vector<std::uint32_t>& corners, int mode) {
  if (mode == TINYGLTF_MODE_TRIANGLES || mode < 0) {
    if (corners.size() % 3 != 0) return bad_gltf("a primitive has a part of a triangle");
    return corners;
  }
  const bool strip = mode == TINYGLTF_MODE_TRIANGLE_STRIP;
  if (!strip && mode != TINYGLTF_MODE_TRIANGLE_FAN)
    return bad_gltf("a primitive holds points or lines: export triangles");
  std::vector<std::uint32_t> list;
  for (std::size_t i = 0; i + 2 < corners.size(); ++i) {
    const std::size_t odd = i & 1U;
    if (strip)
      list.insert(list.end(), {corners[i], corners[i + 1 + odd], corners[i + 2 - odd]});
    else
      list.insert(list.end(), {corners[i + 1], corners[i + 2], corners[0]});
  }
  return list;
}

Result<std::vector<std::uint32_t>> read_triangles(const tinygltf::Model& gltf,
                                                  const tinygltf::Primitive& primitive,
                                                  std::size_t vertices) {
  std::vector<std::uint32_t> corners(vertices);
  if (primitive.indices >= 0) {
    MIXRIG_ASSIGN(corners, read_indices(gltf, primitive.indices));
    if (std::any_of(corners.begin(), corners.end(), [=](std::uint32_t i) { return i >= vertices; }))
      return bad_gltf("an index is out of range");
  } else {
    std::iota(corners.begin(), corners.end(), 0U);
  }
  return triangles(corners, primitive.mode);
}

/// Gives every triangle its own vertices and the normal of its plane, as glTF requires if normals
/// are missing.
void make_flat(Mesh& mesh) {
  Mesh flat;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const std::uint32_t* corner = &mesh.indices[i];
    const Eigen::Vector3f& a = mesh.positions_m[corner[0]];
    const Eigen::Vector3f cross =
        (mesh.positions_m[corner[1]] - a).cross(mesh.positions_m[corner[2]] - a);
    const float length = cross.norm();
    const Eigen::Vector3f normal =
        length > 0 ? Eigen::Vector3f(cross / length) : Eigen::Vector3f::UnitZ();
    for (int k = 0; k < 3; ++k) {
      flat.indices.push_back(static_cast<std::uint32_t>(flat.positions_m.size()));
      flat.positions_m.push_back(mesh.positions_m[corner[k]]);
      flat.normals.push_back(normal);
      if (!mesh.uv.empty()) flat.uv.push_back(mesh.uv[corner[k]]);
    }
  }
  mesh = std::move(flat);
}

/// Returns the transform from glTF's axes (y up): (x, y, z) becomes (x, -z, y).
Eigen::Matrix4d object_from_gltf() {
  Eigen::Matrix4d m;
  m << 1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1;
  return m;
}

void move(Mesh& mesh, const Eigen::Matrix4d& object_from_mesh) {
  const Eigen::Matrix3f linear = object_from_mesh.topLeftCorner<3, 3>().cast<float>();
  const Eigen::Vector3f shift = object_from_mesh.topRightCorner<3, 1>().cast<float>();
  for (Eigen::Vector3f& p : mesh.positions_m) p = linear * p + shift;
  // A mirroring transform turns triangles inside out.
  const double determinant = object_from_mesh.topLeftCorner<3, 3>().determinant();
  if (determinant < 0)
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
      std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);
  // Cofactors: the inverse transpose up to a factor, and defined for a flattened mesh too.
  Eigen::Matrix3f cofactors;
  cofactors << linear.col(1).cross(linear.col(2)), linear.col(2).cross(linear.col(0)),
      linear.col(0).cross(linear.col(1));
  if (determinant < 0) cofactors = -cofactors;
  for (Eigen::Vector3f& n : mesh.normals) n = cofactors * n;
}

/// Normalises; false if a normal has no direction.
bool normalize(std::vector<Eigen::Vector3f>& normals) {
  for (Eigen::Vector3f& n : normals) {
    const float length = n.norm();
    if (!(length > 1e-20F)) return false;
    n /= length;
  }
  return true;
}

/// Adds the morph targets of a primitive by their weights (glTF 2.0, 3.7.2.2).
Result<void> apply_morph(const tinygltf::Model& gltf, const tinygltf::Primitive& primitive,
                         const std::vector<double>& weights, Mesh& mesh) {
  const auto add = [&](const std::map<std::string, int>& target, const char* name, double weight,
                       std::vector<Eigen::Vector3f>& to) -> Result<void> {
    const auto found = target.find(name);
    if (found == target.end() || to.empty()) return {};
    MIXRIG_ASSIGN(const auto moves, read_vec3(gltf, found->second));
    if (moves.size() != to.size()) return bad_gltf("a morph target and its mesh differ in length");
    for (std::size_t i = 0; i < to.size(); ++i) to[i] += static_cast<float>(weight) * moves[i];
    return {};
  };
  for (std::size_t t = 0; t < std::min(weights.size(), primitive.targets.size()); ++t) {
    if (weights[t] == 0) continue;
    MIXRIG_TRY(add(primitive.targets[t], "POSITION", weights[t], mesh.positions_m));
    MIXRIG_TRY(add(primitive.targets[t], "NORMAL", weights[t], mesh.normals));
  }
  return {};
}

}  // namespace

Result<Mesh> read_mesh(const tinygltf::Model& gltf, const tinygltf::Primitive& primitive,
                       const Placement& placement, int uv_set) {
  Mesh mesh;
  if (attribute(primitive, "POSITION") < 0)
    return bad_gltf("a primitive has no positions: export it again");
  MIXRIG_ASSIGN(mesh.positions_m, read_vec3(gltf, attribute(primitive, "POSITION")));
  MIXRIG_ASSIGN(mesh.indices, read_triangles(gltf, primitive, mesh.positions_m.size()));
  if (const int normals = attribute(primitive, "NORMAL"); normals >= 0) {
    MIXRIG_ASSIGN(mesh.normals, read_vec3(gltf, normals));
  }
  if (uv_set >= 0) {
    MIXRIG_ASSIGN(mesh.uv,
                  read_vec2(gltf, attribute(primitive, "TEXCOORD_" + std::to_string(uv_set))));
  }
  const std::size_t count = mesh.positions_m.size();
  if ((!mesh.normals.empty() && mesh.normals.size() != count) ||
      (uv_set >= 0 && mesh.uv.size() != count))
    return bad_gltf("the vertex attributes of a primitive differ in length");
  MIXRIG_TRY(apply_morph(gltf, primitive, placement.morph_weights, mesh));
  if (placement.joints != nullptr) MIXRIG_TRY(apply_skin(gltf, primitive, *placement.joints, mesh));
  move(mesh, object_from_gltf() * placement.world);
  if (mesh.normals.empty() || !normalize(mesh.normals)) make_flat(mesh);
  return mesh;
}

}  // namespace mixrig::scene

// SPDX-License-Identifier: Apache-2.0
// Reads glTF accessors with all bounds checked. Private to this module.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "host/scene/gltf/gltf_file.h"

namespace mixrig::scene {

/// Returns the bytes of a buffer view. Errors: kFormat if an index or a range is out of bounds.
Result<std::span<const std::uint8_t>> view_bytes(const tinygltf::Model& gltf, int view);

/// Read vectors of finite floats, or of bytes or shorts, normalised or whole (joints, texture
/// coordinates, KHR_mesh_quantization). Errors: kFormat, also for sparse accessors, and for a
/// negative value of a VEC4, which holds joints or weights.
Result<std::vector<Eigen::Vector3f>> read_vec3(const tinygltf::Model& gltf, int accessor);
Result<std::vector<Eigen::Vector2f>> read_vec2(const tinygltf::Model& gltf, int accessor);
Result<std::vector<Eigen::Vector4f>> read_vec4(const tinygltf::Model& gltf, int accessor);
/// Reads a float MAT4. Errors: those of read_vec3().
Result<std::vector<Eigen::Matrix4d>> read_mat4(const tinygltf::Model& gltf, int accessor);
/// Reads a SCALAR of unsigned bytes, shorts or ints. Errors: those of read_vec3().
Result<std::vector<std::uint32_t>> read_indices(const tinygltf::Model& gltf, int accessor);

}  // namespace mixrig::scene

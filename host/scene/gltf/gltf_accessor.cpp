// SPDX-License-Identifier: Apache-2.0
// glTF 2.0, section 3.6: accessors.
#include "host/scene/gltf/gltf_accessor.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

namespace mixrig::scene {
namespace {

/// The elements of an accessor, checked to lie inside its buffer.
struct Elements {
  const std::uint8_t* data = nullptr;
  std::size_t count = 0, stride = 0;
  int component_type = 0;
  bool normalized = false;
};

template <typename T>
T load(const std::uint8_t* from) {
  T value;
  std::memcpy(&value, from, sizeof(T));
  return value;
}

Result<Elements> elements_of(const tinygltf::Model& gltf, int index, int type) {
  const std::string name = "accessor " + std::to_string(index);
  if (index < 0 || static_cast<std::size_t>(index) >= gltf.accessors.size())
    return bad_gltf(name + " does not exist");
  const tinygltf::Accessor& accessor = gltf.accessors[static_cast<std::size_t>(index)];
  if (accessor.sparse.isSparse)
    return bad_gltf(name + " is sparse: export without sparse accessors");
  if (accessor.type != type) return bad_gltf(name + " has an unexpected type");
  MIXRIG_ASSIGN(const auto bytes, view_bytes(gltf, accessor.bufferView));
  const int component_bytes =
      tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType));
  const int components = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(type));
  if (component_bytes <= 0 || components <= 0) return bad_gltf(name + " has an unknown type");
  const auto size =
      static_cast<std::size_t>(component_bytes) * static_cast<std::size_t>(components);
  const std::size_t view_stride =
      gltf.bufferViews[static_cast<std::size_t>(accessor.bufferView)].byteStride;
  const std::size_t stride = view_stride != 0 ? view_stride : size;
  if (accessor.count == 0 || stride < size || accessor.byteOffset > bytes.size() ||
      bytes.size() - accessor.byteOffset < size ||
      (bytes.size() - accessor.byteOffset - size) / stride < accessor.count - 1)
    return bad_gltf(name + " reaches past its buffer");
  return Elements{bytes.data() + accessor.byteOffset, accessor.count, stride,
                  accessor.componentType, accessor.normalized};
}

template <typename T>
float whole_number(const std::uint8_t* from, bool normalized) {
  const auto value = static_cast<float>(load<T>(from));
  return normalized ? std::max(value / static_cast<float>(std::numeric_limits<T>::max()), -1.0F)
                    : value;
}

/// Component `c` of an element: a float, or a byte or short as KHR_mesh_quantization has them;
/// unset for other types.
std::optional<float> component(const Elements& in, const std::uint8_t* element, std::size_t c) {
  switch (in.component_type) {
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return load<float>(element + 4 * c);
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return whole_number<std::int8_t>(element + c, in.normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return whole_number<std::uint8_t>(element + c, in.normalized);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return whole_number<std::int16_t>(element + 2 * c, in.normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return whole_number<std::uint16_t>(element + 2 * c, in.normalized);
    default:
      return std::nullopt;
  }
}

template <int N>
Result<std::vector<Eigen::Matrix<float, N, 1>>> read_vectors(const tinygltf::Model& gltf,
                                                             int accessor, int type) {
  MIXRIG_ASSIGN(const Elements in, elements_of(gltf, accessor, type));
  std::vector<Eigen::Matrix<float, N, 1>> out(in.count);
  for (std::size_t i = 0; i < in.count; ++i)
    for (int c = 0; c < N; ++c) {
      const auto value = component(in, in.data + i * in.stride, static_cast<std::size_t>(c));
      if (!value)
        return bad_gltf("accessor " + std::to_string(accessor) +
                        " holds neither floats nor bytes nor shorts");
      if (!std::isfinite(*value))
        return bad_gltf("accessor " + std::to_string(accessor) +
                        " holds a value that is not finite");
      out[i][c] = *value;
    }
  return out;
}

}  // namespace

Result<std::span<const std::uint8_t>> view_bytes(const tinygltf::Model& gltf, int index) {
  const std::string name = "buffer view " + std::to_string(index);
  if (index < 0 || static_cast<std::size_t>(index) >= gltf.bufferViews.size())
    return bad_gltf(name + " does not exist");
  const tinygltf::BufferView& view = gltf.bufferViews[static_cast<std::size_t>(index)];
  if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= gltf.buffers.size())
    return bad_gltf(name + " names a missing buffer");
  const std::span<const std::uint8_t> data(
      gltf.buffers[static_cast<std::size_t>(view.buffer)].data);
  if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset)
    return bad_gltf(name + " reaches past its buffer");
  return data.subspan(view.byteOffset, view.byteLength);
}

Result<std::vector<Eigen::Vector3f>> read_vec3(const tinygltf::Model& gltf, int accessor) {
  return read_vectors<3>(gltf, accessor, TINYGLTF_TYPE_VEC3);
}

Result<std::vector<Eigen::Vector2f>> read_vec2(const tinygltf::Model& gltf, int accessor) {
  return read_vectors<2>(gltf, accessor, TINYGLTF_TYPE_VEC2);
}

Result<std::vector<Eigen::Vector4f>> read_vec4(const tinygltf::Model& gltf, int accessor) {
  MIXRIG_ASSIGN(auto out, read_vectors<4>(gltf, accessor, TINYGLTF_TYPE_VEC4));
  for (const Eigen::Vector4f& four : out)
    if (!(four.minCoeff() >= 0)) return bad_gltf("a joint or weight is negative or not finite");
  return out;
}

Result<std::vector<Eigen::Matrix4d>> read_mat4(const tinygltf::Model& gltf, int accessor) {
  MIXRIG_ASSIGN(const Elements in, elements_of(gltf, accessor, TINYGLTF_TYPE_MAT4));
  if (in.component_type != TINYGLTF_COMPONENT_TYPE_FLOAT)
    return bad_gltf("accessor " + std::to_string(accessor) + " does not hold floats");
  std::vector<Eigen::Matrix4d> out(in.count);
  for (std::size_t i = 0; i < in.count; ++i)
    for (std::size_t k = 0; k < 16; ++k)  // column by column
      out[i](static_cast<int>(k % 4), static_cast<int>(k / 4)) =
          static_cast<double>(load<float>(in.data + i * in.stride + 4 * k));
  return out;
}

Result<std::vector<std::uint32_t>> read_indices(const tinygltf::Model& gltf, int accessor) {
  MIXRIG_ASSIGN(const Elements in, elements_of(gltf, accessor, TINYGLTF_TYPE_SCALAR));
  std::vector<std::uint32_t> out(in.count);
  for (std::size_t i = 0; i < in.count; ++i) {
    const std::uint8_t* from = in.data + i * in.stride;
    switch (in.component_type) {
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        out[i] = *from;
        break;
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        out[i] = load<std::uint16_t>(from);
        break;
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        out[i] = load<std::uint32_t>(from);
        break;
      default:
        return bad_gltf("accessor " + std::to_string(accessor) +
                        " has a type that indices cannot have");
    }
  }
  return out;
}

}  // namespace mixrig::scene

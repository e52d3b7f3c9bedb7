// SPDX-License-Identifier: Apache-2.0
#include "host/scene/gltf/glb_writer.h"

#include <cstring>
#include <sstream>

#include <tiny_gltf.h>

#include "hal/base/partial_path.h"
#include "host/math/image_io/image_io.h"

namespace mixrig::scene {
namespace {

/// Converts object axes (z up) to glTF's (y up).
std::vector<Eigen::Vector3f> to_gltf(const std::vector<Eigen::Vector3f>& vectors) {
  std::vector<Eigen::Vector3f> turned;
  turned.reserve(vectors.size());
  for (const auto& v : vectors) turned.emplace_back(v.x(), v.z(), -v.y());
  return turned;
}

/// Builds a file whose data lie in buffer 0.
class GlbBuilder {
 public:
  GlbBuilder() {
    model_.asset.version = "2.0";
    model_.asset.generator = "mixrig";
    model_.defaultScene = 0;
    model_.scenes.resize(1);
    model_.buffers.resize(1);
  }

  /// Begins a node with a mesh of its own; later additions belong to it.
  void begin_node(const std::string& name) {
    tinygltf::Node node;
    node.name = name;
    node.mesh = static_cast<int>(model_.meshes.size());
    model_.scenes[0].nodes.push_back(static_cast<int>(model_.nodes.size()));
    model_.nodes.push_back(std::move(node));
    model_.meshes.emplace_back();
  }

  void add(const Polyline& line) {
    tinygltf::Primitive primitive;
    primitive.mode = TINYGLTF_MODE_LINE_STRIP;
    primitive.attributes = {{"POSITION", add_positions(line.points_m)}};
    model_.meshes.back().primitives.push_back(std::move(primitive));
  }

  Result<void> add(const Mesh& mesh, ImageView<const Rgb8> texture) {
    MIXRIG_ASSIGN(const int material, add_material(mesh, texture));
    const int position = add_positions(mesh.positions_m);
    tinygltf::Primitive primitive;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.material = material;
    primitive.attributes = {{"POSITION", position},
                            {"NORMAL", add_vertices(to_gltf(mesh.normals), TINYGLTF_TYPE_VEC3)},
                            {"TEXCOORD_0", add_vertices(mesh.uv, TINYGLTF_TYPE_VEC2)}};
    primitive.indices = add_accessor(add_view(mesh.indices, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER),
                                     TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR,
                                     mesh.indices.size());
    model_.meshes.back().primitives.push_back(std::move(primitive));
    return {};
  }

  /// Writes the file. tinygltf does not report a full disk, so it writes to memory first. Errors:
  /// kIo.
  Result<void> write(const std::filesystem::path& path) const {
    std::ostringstream bytes;
    constexpr bool kPretty = false, kBinary = true;
    tinygltf::TinyGLTF().WriteGltfSceneToStream(&model_, bytes, kPretty, kBinary);
    return write_file(path, bytes.str());
  }

 private:
  /// Copies values to the end of the buffer; each view starts at a multiple of 4 bytes.
  template <typename Values>
  int add_view(const Values& values, int target) {
    std::vector<unsigned char>& buffer = model_.buffers[0].data;
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = buffer.size();
    view.byteLength = values.size() * sizeof(values[0]);
    view.target = target;
    buffer.resize((view.byteOffset + view.byteLength + 3) / 4 * 4);
    std::memcpy(buffer.data() + view.byteOffset, values.data(), view.byteLength);
    model_.bufferViews.push_back(std::move(view));
    return static_cast<int>(model_.bufferViews.size()) - 1;
  }

  int add_accessor(int view, int component, int type, std::size_t count) {
    tinygltf::Accessor accessor;
    accessor.bufferView = view;
    accessor.componentType = component;
    accessor.type = type;
    accessor.count = count;
    model_.accessors.push_back(std::move(accessor));
    return static_cast<int>(model_.accessors.size()) - 1;
  }

  template <typename Vector>
  int add_vertices(const std::vector<Vector>& values, int type) {
    return add_accessor(add_view(values, TINYGLTF_TARGET_ARRAY_BUFFER),
                        TINYGLTF_COMPONENT_TYPE_FLOAT, type, values.size());
  }

  /// Adds positions with their range, which glTF requires.
  int add_positions(const std::vector<Eigen::Vector3f>& positions_m) {
    const std::vector<Eigen::Vector3f> turned = to_gltf(positions_m);
    const int added = add_vertices(turned, TINYGLTF_TYPE_VEC3);
    Eigen::Vector3f low = turned.front(), high = low;
    for (const auto& v : turned) low = low.cwiseMin(v), high = high.cwiseMax(v);
    tinygltf::Accessor& accessor = model_.accessors.back();
    accessor.minValues = {low.x(), low.y(), low.z()};
    accessor.maxValues = {high.x(), high.y(), high.z()};
    return added;
  }

  /// Adds a material with texture `picture`, whose PNG is stored in the buffer.
  Result<int> add_material(const Mesh& mesh, ImageView<const Rgb8> picture) {
    const auto number = static_cast<int>(model_.materials.size());
    if (model_.samplers.empty()) {
      tinygltf::Sampler& sampler = model_.samplers.emplace_back();
      sampler.magFilter = sampler.minFilter = TINYGLTF_TEXTURE_FILTER_LINEAR;
    }
    MIXRIG_ASSIGN(const std::string png, image_io::encode_png(picture));
    tinygltf::Image image;
    image.bufferView = add_view(png, 0);
    image.mimeType = "image/png";
    model_.images.push_back(std::move(image));
    tinygltf::Texture texture;
    texture.source = number;
    texture.sampler = 0;
    model_.textures.push_back(std::move(texture));
    tinygltf::Material material;
    material.pbrMetallicRoughness.baseColorTexture.index = number;
    material.pbrMetallicRoughness.metallicFactor = mesh.metallic;
    material.pbrMetallicRoughness.roughnessFactor = mesh.roughness;
    if (mesh.specular != 1) {
      constexpr const char* kSpecular = "KHR_materials_specular";
      material.extensions[kSpecular] =
          tinygltf::Value({{"specularFactor", tinygltf::Value(double{mesh.specular})}});
      if (model_.extensionsUsed.empty()) model_.extensionsUsed.emplace_back(kSpecular);
    }
    model_.materials.push_back(std::move(material));
    return number;
  }

  tinygltf::Model model_;
};

}  // namespace

Result<void> write_glb(const Model& model, const std::string& name,
                       const std::filesystem::path& path) {
  GlbBuilder file;
  file.begin_node(name);
  for (const Mesh& mesh : model.meshes) {
    const auto texture = static_cast<std::size_t>(mesh.texture);
    MIXRIG_TRY(file.add(mesh, model.textures[texture].view()));
  }
  return file.write(path);
}

Result<void> write_glb(const std::vector<Polyline>& lines, const std::filesystem::path& path) {
  GlbBuilder file;
  for (const Polyline& line : lines) {
    file.begin_node(line.name);
    file.add(line);
  }
  return file.write(path);
}

}  // namespace mixrig::scene

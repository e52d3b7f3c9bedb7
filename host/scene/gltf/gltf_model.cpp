// SPDX-License-Identifier: Apache-2.0
// Builds a Model from a glTF file's scene: nodes, materials, textures.
#include "host/scene/gltf/gltf_model.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hal/base/guarded.h"
#include "hal/base/log.h"
#include "host/math/config/table.h"
#include "host/math/image_io/image_io.h"
#include "host/scene/gltf/gltf_accessor.h"
#include "host/scene/gltf/gltf_declared.h"
#include "host/scene/gltf/gltf_file.h"
#include "host/scene/gltf/gltf_maps.h"
#include "host/scene/gltf/gltf_mesh.h"
#include "host/scene/gltf/gltf_skin.h"
#include "host/scene/gltf/gltf_texels.h"
#include "host/scene/scene.h"

namespace mixrig::scene {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMaxModelBytes = std::size_t{1} << 30;
/// Most of a model. Meshes count as often as nodes use them, pictures as often as they are listed.
constexpr std::size_t kMaxVertices = 20'000'000, kMaxCorners = 3 * kMaxVertices;
constexpr int kMaxNodeDepth = 64;
constexpr double kMostStrength = 1e6;  ///< largest emissive strength
constexpr double kMostBend = 100;      ///< largest factor of a normal map

/// Makes a model of a parsed file. Each node is used at most once, as glTF requires of its trees.
class ModelBuilder {
 public:
  explicit ModelBuilder(const GltfFile& file) : file_(file), visited_(file.gltf.nodes.size()) {}

  Result<Model> build() {
    MIXRIG_TRY(check_pictures());
    MIXRIG_TRY(check_meshes());
    for (const int root : roots()) MIXRIG_TRY(add_node(root, Eigen::Matrix4d::Identity(), 0));
    if (model_.meshes.empty()) return bad_gltf("has no triangles");
    return std::move(model_);
  }

 private:
  std::vector<int> roots() const {
    const auto& scenes = file_.gltf.scenes;
    const auto chosen = static_cast<std::size_t>(std::max(file_.gltf.defaultScene, 0));
    if (chosen < scenes.size()) return scenes[chosen].nodes;
    std::vector<bool> is_child(file_.gltf.nodes.size());
    for (const tinygltf::Node& node : file_.gltf.nodes)
      for (const int child : node.children)
        if (child >= 0 && static_cast<std::size_t>(child) < is_child.size())
          is_child[static_cast<std::size_t>(child)] = true;
    std::vector<int> list;
    for (std::size_t i = 0; i < is_child.size(); ++i)
      if (!is_child[i]) list.push_back(static_cast<int>(i));
    return list;
  }

  Result<void> add_node(int index, const Eigen::Matrix4d& parent, int depth) {
    if (index < 0 || static_cast<std::size_t>(index) >= visited_.size())
      return bad_gltf("node " + std::to_string(index) + " does not exist");
    if (visited_[static_cast<std::size_t>(index)] || depth > kMaxNodeDepth)
      return bad_gltf("its nodes are not a tree of at most 64 levels");
    visited_[static_cast<std::size_t>(index)] = true;
    const tinygltf::Node& node = file_.gltf.nodes[static_cast<std::size_t>(index)];
    const Eigen::Matrix4d world = parent * local_matrix(node);
    if (!world.allFinite())
      return bad_gltf("node " + std::to_string(index) + " has a transform that is not finite");
    if (node.mesh >= 0) MIXRIG_TRY(add_mesh(node, world));
    for (const int child : node.children) MIXRIG_TRY(add_node(child, world, depth + 1));
    return {};
  }

  /// The place of a skinned mesh is that of its joints, whatever its node.
  Result<void> add_mesh(const tinygltf::Node& node, const Eigen::Matrix4d& node_world) {
    const int index = node.mesh;
    const bool skinned = node.skin >= 0;
    std::vector<Eigen::Matrix4d> joints;
    if (skinned) {
      MIXRIG_ASSIGN(joints, joint_matrices(file_.gltf, node.skin));
    }
    Placement placement;
    if (skinned)
      placement.joints = &joints;
    else
      placement.world = node_world;
    if (static_cast<std::size_t>(index) >= file_.gltf.meshes.size())
      return bad_gltf("mesh " + std::to_string(index) + " does not exist");
    const tinygltf::Mesh& source = file_.gltf.meshes[static_cast<std::size_t>(index)];
    placement.morph_weights = node.weights.empty() ? source.weights : node.weights;
    if (!std::ranges::all_of(placement.morph_weights, [](double w) { return std::isfinite(w); }))
      return bad_gltf("a morph weight is not finite");
    for (const tinygltf::Primitive& primitive : source.primitives) {
      const tinygltf::Material material = material_of(primitive.material);
      MIXRIG_ASSIGN(const MapCoordinates coordinates, coordinates_of(material, name_of(material)));
      const int uv_set = coordinates.set;
      if (uv_set >= 0 && primitive.attributes.count("TEXCOORD_" + std::to_string(uv_set)) == 0)
        return bad_gltf(
            name_of(material) +
            " has a picture, but a mesh that uses it has no texture coordinates: unwrap "
            "it, or remove the picture");
      MIXRIG_ASSIGN(Mesh mesh, read_mesh(file_.gltf, primitive, placement, uv_set));
      if (mesh.indices.empty()) continue;
      for (Eigen::Vector2f& uv : mesh.uv) uv = coordinates.transform * uv.homogeneous();
      set_factors(material, mesh);
      MIXRIG_TRY(set_maps(material, mesh));
      model_.meshes.push_back(std::move(mesh));
    }
    return {};
  }

  static std::string name_of(const tinygltf::Material& material) {
    return "material '" + material.name.substr(0, 100) + "'";
  }

  static void set_factors(const tinygltf::Material& material, Mesh& mesh) {
    const auto& pbr = material.pbrMetallicRoughness;
    mesh.base_color = color_of(pbr.baseColorFactor, mesh.base_color);
    mesh.emission = color_of(material.emissiveFactor, mesh.emission);
    const double strength =
        factor_of(material, "KHR_materials_emissive_strength", "emissiveStrength");
    mesh.emission = (static_cast<float>(strength) * mesh.emission).cwiseMin(1.0F);
    mesh.metallic = share_of(pbr.metallicFactor), mesh.roughness = share_of(pbr.roughnessFactor);
    mesh.specular = share_of(factor_of(material, "KHR_materials_specular", "specularFactor"));
    mesh.normal_scale =
        static_cast<float>(std::clamp(material.normalTexture.scale, -kMostBend, kMostBend));
    mesh.double_sided = material.doubleSided;
  }
  static float share_of(double factor) { return static_cast<float>(std::clamp(factor, 0.0, 1.0)); }
  static Eigen::Vector3f color_of(const std::vector<double>& factor,
                                  const Eigen::Vector3f& fallback) {
    if (factor.size() < 3) return fallback;
    return {share_of(factor[0]), share_of(factor[1]), share_of(factor[2])};
  }
  /// Returns a number of an extension of a material; 1 if it is absent.
  static double factor_of(const tinygltf::Material& material, const char* extension,
                          const char* key) {
    const auto found = material.extensions.find(extension);
    if (found == material.extensions.end() || !found->second.Has(key)) return 1;
    const tinygltf::Value& value = found->second.Get(key);
    return value.IsNumber() ? std::clamp(value.GetNumberAsDouble(), 0.0, kMostStrength) : 1;
  }

  Result<void> set_maps(const tinygltf::Material& material, Mesh& mesh) {
    const auto& pbr = material.pbrMetallicRoughness;
    const auto set = [&](int index, int& map) -> Result<void> {
      if (index < 0) return {};
      MIXRIG_ASSIGN(map, texture(index, name_of(material)));
      return {};
    };
    MIXRIG_TRY(set(pbr.baseColorTexture.index, mesh.texture));
    MIXRIG_TRY(set(pbr.metallicRoughnessTexture.index, mesh.gloss_map));
    MIXRIG_TRY(set(material.normalTexture.index, mesh.normal_map));
    return set(material.emissiveTexture.index, mesh.emission_map);
  }

  /// Returns a material. For -1 and an index out of range it is the default one, which has no
  /// texture.
  tinygltf::Material material_of(int index) const {
    const auto& materials = file_.gltf.materials;
    return index >= 0 && static_cast<std::size_t>(index) < materials.size()
               ? materials[static_cast<std::size_t>(index)]
               : tinygltf::Material();
  }

  /// Returns the index in Model::textures of a glTF texture; each picture is decoded once.
  Result<int> texture(int index, const std::string& material) {
    const auto& textures = file_.gltf.textures;
    const int source = static_cast<std::size_t>(index) < textures.size()
                           ? textures[static_cast<std::size_t>(index)].source
                           : -1;
    if (source < 0 || static_cast<std::size_t>(source) >= file_.gltf.images.size())
      return bad_gltf(no_picture(index, material));
    if (const auto known = texture_of_image_.find(source); known != texture_of_image_.end())
      return known->second;
    MIXRIG_ASSIGN(const auto bytes, picture_bytes(static_cast<std::size_t>(source)));
    const std::string name = picture_name(static_cast<std::size_t>(source));
    if (bytes.empty())
      return bad_gltf("its picture '" + name + "' is missing: put it beside the model");
    Image<Rgb8> pixels;
    MIXRIG_TRY(image_io::decode_rgb8(bytes.data(), bytes.size(), name, pixels));
    model_.textures.push_back(std::move(pixels));
    return texture_of_image_[source] = static_cast<int>(model_.textures.size()) - 1;
  }

  Result<std::span<const std::uint8_t>> picture_bytes(std::size_t image) const {
    const int view = file_.gltf.images[image].bufferView;
    if (view >= 0) return view_bytes(file_.gltf, view);
    return std::span<const std::uint8_t>(file_.pictures[image]);
  }

  std::string picture_name(std::size_t image) const {
    const std::string& uri = file_.gltf.images[image].uri;
    return uri.empty() ? "picture " + std::to_string(image) : uri.substr(0, 200);
  }

  /// Many nodes may use one mesh: what they sum up to is checked before one is read.
  Result<void> check_meshes() const {
    std::size_t vertices = 0, corners = 0;
    for (const tinygltf::Node& node : file_.gltf.nodes) {
      if (node.mesh < 0 || static_cast<std::size_t>(node.mesh) >= file_.gltf.meshes.size())
        continue;  // refused where it is used
      for (const auto& part : file_.gltf.meshes[static_cast<std::size_t>(node.mesh)].primitives) {
        const auto position = part.attributes.find("POSITION");
        const std::size_t own = position == part.attributes.end() ? 0 : count_of(position->second);
        vertices += std::clamp<std::size_t>(own, 1, kMaxVertices + 1) * (1 + part.targets.size());
        corners += std::min(part.indices < 0 ? own : count_of(part.indices), kMaxCorners + 1);
        if (vertices > kMaxVertices || corners > kMaxCorners)
          return bad_gltf("has more than 20 million vertices or triangles: simplify it");
      }
    }
    return {};
  }
  /// Values of an accessor, at most one a byte of its view: what goes beyond is refused when it is
  /// read.
  std::size_t count_of(int accessor) const {
    const auto index = static_cast<std::size_t>(accessor);
    if (index >= file_.gltf.accessors.size()) return 0;
    const auto view = static_cast<std::size_t>(file_.gltf.accessors[index].bufferView);
    if (view >= file_.gltf.bufferViews.size()) return 0;
    return std::min(file_.gltf.accessors[index].count, file_.gltf.bufferViews[view].byteLength);
  }

  /// A picture of a few bytes may state any size: their sum is checked before one is decoded.
  Result<void> check_pictures() const {
    TexelCount texels;
    for (std::size_t i = 0; i < file_.gltf.images.size(); ++i) {
      const auto bytes = picture_bytes(i);
      if (!bytes || bytes->empty()) continue;  // refused where it is used
      texels.add(*bytes);
      if (texels.is_too_many()) return too_many_texels();
    }
    return {};
  }

  /// Why a texture has no picture that is read.
  std::string no_picture(int index, const std::string& material) const {
    const auto& textures = file_.gltf.textures;
    if (static_cast<std::size_t>(index) < textures.size())
      for (const auto& [extension, value] : textures[static_cast<std::size_t>(index)].extensions)
        if (const std::string format = picture_format_of(extension); !format.empty())
          return "the picture of " + material + " is " + format + " (" + extension +
                 "): use PNG or JPEG";
    return material + " names a texture without a picture: export it again";
  }

  const GltfFile& file_;
  std::vector<bool> visited_;
  std::map<int, int> texture_of_image_;
  Model model_;
};

}  // namespace

Result<Model> parse_model(std::span<const std::uint8_t> bytes, const fs::path& folder,
                          std::vector<std::string>* without) {
  MIXRIG_ASSIGN(const GltfFile file, parse_gltf(bytes, folder));
  if (without != nullptr) *without = file.without;
  return ModelBuilder(file).build();
}

Result<Model> load_gltf(const fs::path& path) {
  Model model;
  MIXRIG_TRY(guarded("model '" + path.string() + "'", [&]() -> Result<void> {
    MIXRIG_ASSIGN(const std::string text, config::read_text(path, kMaxModelBytes));
    const std::span bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
    std::vector<std::string> without;
    auto parsed =
        parse_model(bytes, path.has_parent_path() ? path.parent_path() : fs::path("."), &without);
    if (!parsed)
      return Error{ErrorCode::kFormat,
                   "cannot read model '" + path.string() + "': " + parsed.error().context};
    if (!without.empty())
      log_warning("scene", fmt::format("model '{}' is drawn without {}: export it without",
                                       path.string(), fmt::join(without, ", ")));
    model = *std::move(parsed);
    return {};
  }));
  return model;
}

Bounds bounds(const Model& model) {
  Bounds box{model.meshes.front().positions_m.front(), model.meshes.front().positions_m.front()};
  for (const Mesh& mesh : model.meshes)
    for (const Eigen::Vector3f& p : mesh.positions_m) {
      box.min_m = box.min_m.cwiseMin(p);
      box.max_m = box.max_m.cwiseMax(p);
    }
  return box;
}

}  // namespace mixrig::scene

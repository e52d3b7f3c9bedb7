// SPDX-License-Identifier: Apache-2.0
// The studio's object as a binary glTF 2.0 file.
#include "host/app/glb_writer.h"

#include <cstring>
#include <fstream>
#include <iterator>
#include <span>

#include <nlohmann/json.hpp>

#include "host/image_io/image_io.h"

namespace mixrig::app {
namespace {

using nlohmann::json;
using Bytes = std::vector<char>;

constexpr int kFloat = 5126, kUint = 5125;  // component types of glTF
constexpr int kArrayBuffer = 34962, kElementBuffer = 34963;

/// Object axes (z up) to glTF's (y up).
Eigen::Vector3f to_gltf(const Eigen::Vector3f& p) { return {p.x(), p.z(), -p.y()}; }

Result<Bytes> png_bytes(ImageView<const Rgb8> image, const std::filesystem::path& scratch) {
  MIXRIG_TRY(image_io::write_png(scratch, image));
  std::ifstream file(scratch, std::ios::binary);
  Bytes bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  file.close();
  std::error_code ignored;
  std::filesystem::remove(scratch, ignored);
  if (bytes.empty()) return Error{ErrorCode::kIo, "cannot read back " + scratch.string()};
  return bytes;
}

/// Collects the binary chunk and the parts of the JSON that point into it.
struct Builder {
  Bytes bin;
  json views = json::array(), accessors = json::array();

  int add_view(const void* data, std::size_t size, int target) {
    json view = {{"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", size}};
    if (target != 0) view["target"] = target;
    const char* bytes = static_cast<const char*>(data);
    bin.insert(bin.end(), bytes, bytes + size);
    bin.resize((bin.size() + 3) / 4 * 4, 0);
    views.push_back(std::move(view));
    return static_cast<int>(views.size()) - 1;
  }
  int add_accessor(int view, int component, std::size_t count, const char* type) {
    accessors.push_back(
        {{"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}});
    return static_cast<int>(accessors.size()) - 1;
  }
  int add_vectors(const std::vector<Eigen::Vector3f>& vectors, bool with_range) {
    std::vector<Eigen::Vector3f> turned;
    for (const auto& v : vectors) turned.push_back(to_gltf(v));
    const int view = add_view(turned.data(), turned.size() * sizeof(turned[0]), kArrayBuffer);
    const int accessor = add_accessor(view, kFloat, turned.size(), "VEC3");
    if (!with_range) return accessor;
    Eigen::Vector3f low = turned.front(), high = low;
    for (const auto& v : turned) low = low.cwiseMin(v), high = high.cwiseMax(v);
    accessors.back()["min"] = {low.x(), low.y(), low.z()};
    accessors.back()["max"] = {high.x(), high.y(), high.z()};
    return accessor;
  }
  json add_mesh(const studio::ObjectMesh& mesh, int material) {
    const int uv = add_view(mesh.uv.data(), mesh.uv.size() * sizeof(mesh.uv[0]), kArrayBuffer);
    const int index = add_view(mesh.indices.data(), mesh.indices.size() * sizeof(mesh.indices[0]),
                               kElementBuffer);
    return {{"attributes",
             {{"POSITION", add_vectors(mesh.positions_m, true)},
              {"NORMAL", add_vectors(mesh.normals, false)},
              {"TEXCOORD_0", add_accessor(uv, kFloat, mesh.uv.size(), "VEC2")}}},
            {"indices", add_accessor(index, kUint, mesh.indices.size(), "SCALAR")},
            {"material", material}};
  }
};

Result<json> build_json(const studio::VirtualObject& object, const std::filesystem::path& scratch,
                        Builder& builder) {
  json primitives = json::array(), materials = json::array(), textures = json::array(),
       images = json::array();
  for (const studio::ObjectMesh& mesh : object.meshes) {
    const auto number = static_cast<int>(materials.size());
    MIXRIG_ASSIGN(const Bytes png, png_bytes(mesh.texture.view(), scratch));
    images.push_back(
        {{"bufferView", builder.add_view(png.data(), png.size(), 0)}, {"mimeType", "image/png"}});
    textures.push_back({{"source", number}, {"sampler", 0}});
    materials.push_back({{"pbrMetallicRoughness",
                          {{"baseColorTexture", {{"index", number}}},
                           {"metallicFactor", 0.0},
                           {"roughnessFactor", 1.0}}}});
    primitives.push_back(builder.add_mesh(mesh, number));
  }
  return json{{"asset", {{"version", "2.0"}, {"generator", "mixrig studio"}}},
              {"scene", 0},
              {"scenes", {{{"nodes", {0}}}}},
              {"nodes", {{{"mesh", 0}, {"name", object.name}}}},
              {"meshes", {{{"primitives", primitives}}}},
              {"materials", materials},
              {"textures", textures},
              {"samplers",
               {{{"magFilter", 9729}, {"minFilter", 9729}, {"wrapS", 10497}, {"wrapT", 10497}}}},
              {"images", images},
              {"accessors", builder.accessors},
              {"bufferViews", builder.views},
              {"buffers", {{{"byteLength", builder.bin.size()}}}}};
}

void put_u32(std::ofstream& file, std::size_t value) {
  const auto v = static_cast<std::uint32_t>(value);
  for (int shift = 0; shift < 32; shift += 8) file.put(static_cast<char>((v >> shift) & 0xFFU));
}

}  // namespace

Result<void> write_glb(const studio::VirtualObject& object, const std::filesystem::path& path) {
  const std::filesystem::path partial = path.string() + ".partial";
  Builder builder;
  MIXRIG_ASSIGN(const json document, build_json(object, partial, builder));
  std::string text = document.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::ofstream file(partial, std::ios::binary);
  file.write("glTF", 4);
  put_u32(file, 2);
  put_u32(file, 12 + 8 + text.size() + 8 + builder.bin.size());
  put_u32(file, text.size());
  file.write("JSON", 4);
  file.write(text.data(), static_cast<std::streamsize>(text.size()));
  put_u32(file, builder.bin.size());
  file.write("BIN\0", 4);
  file.write(builder.bin.data(), static_cast<std::streamsize>(builder.bin.size()));
  file.close();
  std::error_code failed;
  if (file) std::filesystem::rename(partial, path, failed);
  if (!file || failed)
    return Error{ErrorCode::kIo, "cannot write " + path.string() + ": check the disk's free space"};
  return {};
}

}  // namespace mixrig::app

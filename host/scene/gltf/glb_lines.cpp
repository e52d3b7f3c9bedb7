// SPDX-License-Identifier: Apache-2.0
#include "host/scene/gltf/glb_lines.h"

#include <cstring>
#include <sstream>

#include <tiny_gltf.h>

#include "hal/base/partial_path.h"

namespace mixrig::scene {
namespace {

void add_line(const Polyline& line, tinygltf::Model& model) {
  std::vector<Eigen::Vector3f> points;  // y up
  for (const Eigen::Vector3f& p : line.points_m) points.emplace_back(p.x(), p.z(), -p.y());
  Eigen::Vector3f low = points.front(), high = low;
  for (const Eigen::Vector3f& p : points) low = low.cwiseMin(p), high = high.cwiseMax(p);
  std::vector<unsigned char>& bytes = model.buffers[0].data;
  tinygltf::BufferView view;
  view.buffer = 0;
  view.byteOffset = bytes.size();
  view.byteLength = points.size() * sizeof(points[0]);
  view.target = TINYGLTF_TARGET_ARRAY_BUFFER;
  bytes.resize(view.byteOffset + view.byteLength);
  std::memcpy(bytes.data() + view.byteOffset, points.data(), view.byteLength);
  tinygltf::Accessor accessor;
  accessor.bufferView = static_cast<int>(model.bufferViews.size());
  accessor.componentType = TINYGLTF_COMPONENT_TYPE_FLOAT;
  accessor.type = TINYGLTF_TYPE_VEC3;
  accessor.count = points.size();
  accessor.minValues = {low.x(), low.y(), low.z()};
  accessor.maxValues = {high.x(), high.y(), high.z()};
  tinygltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_LINE_STRIP;
  primitive.attributes = {{"POSITION", static_cast<int>(model.accessors.size())}};
  tinygltf::Mesh mesh;
  mesh.primitives.push_back(std::move(primitive));
  tinygltf::Node node;
  node.name = line.name;
  node.mesh = static_cast<int>(model.meshes.size());
  model.scenes[0].nodes.push_back(static_cast<int>(model.nodes.size()));
  model.bufferViews.push_back(std::move(view));
  model.accessors.push_back(std::move(accessor));
  model.meshes.push_back(std::move(mesh));
  model.nodes.push_back(std::move(node));
}

}  // namespace

Result<void> write_glb_lines(const std::vector<Polyline>& lines,
                             const std::filesystem::path& path) {
  tinygltf::Model model;
  model.asset.version = "2.0";
  model.asset.generator = "mixrig";
  model.defaultScene = 0;
  model.scenes.resize(1);
  model.buffers.resize(1);
  for (const Polyline& line : lines) add_line(line, model);
  // tinygltf does not report a full disk, so it writes to memory.
  std::ostringstream bytes;
  constexpr bool kPretty = false, kBinary = true;
  tinygltf::TinyGLTF().WriteGltfSceneToStream(&model, bytes, kPretty, kBinary);
  return write_file(path, bytes.str());
}

}  // namespace mixrig::scene

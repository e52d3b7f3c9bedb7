// SPDX-License-Identifier: Apache-2.0
#include "host/scene/gltf/gltf_maps.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace mixrig::scene {
namespace {

constexpr double kMostTransform = 1e6;

/// A number of an extension, or element `i` of a list there.
double number_of(const tinygltf::Value& extension, const char* key, int i, double fallback) {
  if (!extension.Has(key)) return fallback;
  const tinygltf::Value& value = extension.Get(key);
  if (value.IsNumber()) return value.GetNumberAsDouble();
  return value.IsArray() && static_cast<std::size_t>(i) < value.ArrayLen() &&
                 value.Get(i).IsNumber()
             ? value.Get(i).GetNumberAsDouble()
             : fallback;
}

/// Scale, then a turn, then a shift; unset out of range.
std::optional<MapCoordinates> coordinates_of_map(int set, const tinygltf::ExtensionMap& all) {
  MapCoordinates out{set};
  const auto found = all.find("KHR_texture_transform");
  if (found == all.end()) return out;
  const auto number = [&](const char* key, int i, double fallback) {
    return number_of(found->second, key, i, fallback);
  };
  const double texture_set = number("texCoord", 0, set), turn = number("rotation", 0, 0);
  const double sx = number("scale", 0, 1), sy = number("scale", 1, 1);
  Eigen::Matrix<double, 2, 3> m;
  m << std::cos(turn) * sx, std::sin(turn) * sy, number("offset", 0, 0),  //
      -std::sin(turn) * sx, std::cos(turn) * sy, number("offset", 1, 0);
  if (!m.allFinite() || m.cwiseAbs().maxCoeff() > kMostTransform || !(texture_set >= 0) ||
      texture_set > kMostTransform)
    return std::nullopt;
  out.set = static_cast<int>(texture_set);
  out.transform = m.cast<float>();
  return out;
}

}  // namespace

Result<MapCoordinates> coordinates_of(const tinygltf::Material& material, const std::string& name) {
  std::vector<std::optional<MapCoordinates>> maps;
  const auto add = [&](const auto& map) {
    if (map.index >= 0) maps.push_back(coordinates_of_map(map.texCoord, map.extensions));
  };
  const auto& pbr = material.pbrMetallicRoughness;
  add(pbr.baseColorTexture), add(pbr.metallicRoughnessTexture);
  add(material.normalTexture), add(material.emissiveTexture);
  if (maps.empty()) return MapCoordinates{};
  if (!std::ranges::all_of(maps, [](const auto& map) { return map.has_value(); }))
    return bad_gltf("the texture transform of " + name + " is out of range: export it again");
  if (std::ranges::count(maps, maps[0]) < std::ssize(maps))
    return bad_gltf("the maps of " + name +
                    " use different texture coordinates: export them with one UV map");
  return *maps[0];
}

}  // namespace mixrig::scene

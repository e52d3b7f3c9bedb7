// SPDX-License-Identifier: Apache-2.0
// Texture coordinates of a material's maps. Private to this module.
#pragma once

#include <string>

#include <Eigen/Core>

#include "host/scene/gltf/gltf_file.h"

namespace mixrig::scene {

/// Which texture coordinates maps use, and the affine transform that comes first.
struct MapCoordinates {
  int set = -1;  ///< n of TEXCOORD_n; -1 without a map
  Eigen::Matrix<float, 2, 3> transform = Eigen::Matrix<float, 2, 3>::Identity();
  bool operator==(const MapCoordinates&) const = default;
};

/// Returns those of a material, with KHR_texture_transform. Errors: kFormat where its maps differ,
/// or a transform is out of range; `name` begins the words.
Result<MapCoordinates> coordinates_of(const tinygltf::Material& material, const std::string& name);

}  // namespace mixrig::scene

// SPDX-License-Identifier: Apache-2.0
// The panorama of a room as textured triangles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "host/room/scan/panorama/panorama.h"

namespace mixrig::model {

/// Triangles of a room in axes and origin of the panorama. Vertex arrays are of equal length.
struct RoomMesh {
  std::vector<Eigen::Vector3f> positions_m;
  std::vector<Eigen::Vector3f> normals;  ///< unit, towards the origin's side
  std::vector<Eigen::Vector2f> uv;     ///< of the panorama's colour picture, v downwards; u of the
                                       ///< last column is above 1: the picture repeats
  std::vector<std::uint32_t> indices;  ///< three a triangle, counter-clockwise from the origin
};

/// Makes two triangles for each four neighbouring pixels, none across a depth step or an unknown
/// pixel; a fan closes each pole. No normals.
RoomMesh grid_mesh(const Panorama& panorama);

/// Distance by which simplification may move a surface: 1.25 times the median sigma of the measured
/// distances, since smaller details are noise, and at most a quarter of the width of a pixel on the
/// surface and 2 mm.
double mesh_tolerance_m(const Panorama& panorama);

/// Simplifies a mesh: meshoptimizer collapses edges while their quadric error is within
/// `tolerance_m`, in sectors of azimuth in parallel and then over their borders (Schiller et al.
/// 2010, section 4.2, name the decimation of Schroeder et al.). Then edges are halved where the
/// texture, interpolated linearly along them, would be off by more than a pixel. With normals.
RoomMesh simplified(const RoomMesh& grid, Size panorama, double tolerance_m, Crew& crew);

}  // namespace mixrig::model

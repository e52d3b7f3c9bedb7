// SPDX-License-Identifier: Apache-2.0
// A room's panorama as pictures that the compositor can draw: the faces of a cube around it.
#pragma once

#include <vector>

#include "hal/base/parallel.h"
#include "host/math/geometry/camera_model.h"
#include "host/math/geometry/pose.h"
#include "host/room/scan/panorama/panorama.h"

namespace mixrig::model {

/// Faces of the cube, one below the other in the images; faces without known pixels are left out.
struct RoomFaces {
  geometry::Pinhole camera;  ///< of each face; faces overlap by a margin of two depth samples
  std::vector<geometry::Pose> base_from_face;  ///< camera axes: x right, y down, z ahead
  Image<float> depth_m;                        ///< z, 0 unknown
  Image<float> depth_sigma_m;
  Image<Rgbx8> color;    ///< learned_color(); its spread covers shifts by up to half a pixel
  int color_factor = 1;  ///< colour pixels per depth pixel, along a side
};

/// Makes the faces; in the middle of a face the resolution is that of the panorama.
RoomFaces make_faces(const Panorama& panorama, Crew& crew);

/// Writes differences between two states of a panorama's faces back to it: distances, sigmas,
/// colours. Pixels that became known count as seen by one view. Both states have the layout of
/// make_faces(panorama).
void take_changes(const RoomFaces& before, const RoomFaces& after, Panorama& panorama);

}  // namespace mixrig::model

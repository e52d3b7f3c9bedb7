// SPDX-License-Identifier: Apache-2.0
// A room's panorama as pictures that the compositor can draw: the faces of a cube around it.
#pragma once

#include <vector>

#include "hal/base/parallel.h"
#include "host/math/geometry/camera_model.h"
#include "host/math/geometry/pose.h"
#include "host/room/scan/panorama/panorama.h"

namespace mixrig::model {

/// The faces stand below one another in the images; those that know nothing are left out.
struct RoomFaces {
  geometry::Pinhole camera;  ///< of each face; a margin of two depth samples overlaps with others
  std::vector<geometry::Pose> base_from_face;  ///< camera axes: x right, y down, z ahead
  Image<float> depth_m;                        ///< z, 0 unknown
  Image<float> depth_sigma_m;
  Image<Rgbx8> color;    ///< learned_color(); its spread is that of shifts by up to half a pixel
  int color_factor = 1;  ///< pixels of it a pixel of depth, along a side
};

/// In the middle of a face as many pixels as the panorama has.
RoomFaces make_faces(const Panorama& panorama, Crew& crew);

/// Gives what differs between two states of the faces of a panorama back to it: distances, sigmas,
/// colours. What became known is seen by one view. Both have the layout of make_faces(panorama).
void take_changes(const RoomFaces& before, const RoomFaces& after, Panorama& panorama);

}  // namespace mixrig::model

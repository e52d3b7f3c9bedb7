// SPDX-License-Identifier: Apache-2.0
// Draws paths of people over the plan of the room, and in the camera's picture (Schiller et al.
// 2010, figure 11).
#pragma once

#include <span>

#include "extras/people/plan/floor_map.h"
#include "extras/people/plan/placing.h"
#include "extras/people/watch/people_sink.h"
#include "hal/base/image.h"

namespace mixrig::session {

struct PlanDrawing {
  const plan::FloorMap& map;
  std::span<const PersonPath> people;
  std::span<const plan::FreePlace> places;  ///< suggested
  plan::Footprint box;                      ///< size of the object at these places
  double margin_m;                          ///< between objects and what stands in the room
  geometry::Pose world_from_camera;         ///< pose of the first frame
  geometry::Pinhole view;
};

/// Draws the room from above, x to the right and y up: free floor tinted, less within the margin; a
/// path for each person, with number and height, a dot each second, dashes where the person was
/// hidden; the camera and the suggested places.
Image<Rgb8> draw_plan(const PlanDrawing& drawing);
/// Draws the room from above with the time that people spent in each cell, red where it is longest.
Image<Rgb8> draw_dwell(const PlanDrawing& drawing, const plan::DwellGrid& dwell);
/// Draws paths and places into a picture of the camera, of the size of the view.
Image<Rgb8> draw_in_picture(const PlanDrawing& drawing, ImageView<const Rgb8> picture);

}  // namespace mixrig::session

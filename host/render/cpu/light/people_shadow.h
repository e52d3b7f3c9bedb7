// SPDX-License-Identifier: Apache-2.0
// Pass shadow for people: what they hide from the lamps. The depth camera sees only their front, so
// each block of the view that shows a person becomes a ball behind the measured surface, as thick
// as the silhouette is wide there (docs/method/light.md).
#pragma once

#include <vector>

#include "host/render/cpu/light/people_grid.h"
#include "host/render/cpu/light/shadow.h"

namespace mixrig::render::cpu {

/// A part of a person; camera axes, metres.
struct Ball {
  glm::vec3 center_m{0};
  float radius_m = 0;  ///< 0: nobody
};

/// Memory of the pass, with one entry for each block of kBlockPx pixels.
struct PeopleShadow {
  PeopleShadow() = default;
  explicit PeopleShadow(Size view_size);
  Image<float> z_m;  ///< depth of people; very large where less than half of the block shows any
  std::vector<Ball> balls;        ///< radius 0 also if no lamp's map shows it
  std::vector<Ball> drawn;        ///< the balls with a radius
  std::vector<ShadowMap> maps;    ///< one a lamp
  std::vector<LampParams> lamps;  ///< frame.people_lamps, with casters_near_m of their nearest ball
  LampSet reach = 0;              ///< lamps whose maps show anybody
  PeopleGrid grid;
};

/// Draws balls for the people that `matte` and their inverse depth `view_w` show into the map of
/// each lamp of frame.people_lamps, and fills the grid. Allocates in the first frame only.
void draw_people_maps(Crew& crew, const FrameParams& frame, const PinholeParams& view,
                      const Image<float>& view_w, const Image<std::uint8_t>& matte,
                      PeopleShadow& people);

}  // namespace mixrig::render::cpu

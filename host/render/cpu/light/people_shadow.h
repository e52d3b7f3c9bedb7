// SPDX-License-Identifier: Apache-2.0
// Pass shadow: what people hide from the lamps. The depth camera sees their front alone, so each
// block of the view that shows a person is a ball behind the measured surface, as thick as the
// silhouette is wide there (docs/method/compositor.md, "Light").
#pragma once

#include <vector>

#include "host/render/cpu/light/people_grid.h"
#include "host/render/cpu/light/shadow.h"

namespace mixrig::render::cpu {

/// Camera axes, metres.
struct Ball {
  glm::vec3 center_m{0};
  float radius_m = 0;  ///< 0: nobody
};

/// Memory of the pass: one entry for each block of kBlockPx pixels.
struct PeopleShadow {
  PeopleShadow() = default;
  explicit PeopleShadow(Size view_size);
  Image<float> z_m;             ///< of people; very far where less than half of the block shows any
  std::vector<Ball> balls;      ///< radius 0 too where no lamp's map shows it
  std::vector<Ball> drawn;      ///< the others
  std::vector<ShadowMap> maps;  ///< of each lamp
  std::vector<LampParams> lamps;  ///< frame.people_lamps, with the nearest of their casters
  LampSet reach = 0;              ///< lamps whose maps show anybody
  PeopleGrid grid;
};

/// Balls of the people that `matte` and their inverse depth `view_w` show, into the map of every
/// lamp of frame.people_lamps, and what they hide into the grid. Allocates in the first frame
/// only.
void draw_people_maps(Crew& crew, const FrameParams& frame, const PinholeParams& view,
                      const Image<float>& view_w, const Image<std::uint8_t>& matte,
                      PeopleShadow& people);

}  // namespace mixrig::render::cpu

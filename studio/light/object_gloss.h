// SPDX-License-Identifier: Apache-2.0
// Traces what a glossy virtual object reflects of lamps and room.
#pragma once

#include "studio/light/reflection.h"

namespace mixrig::studio {

/// Sets the mirrored light of the object's surfels, less the diffuse light that it takes from them:
/// a dielectric of 4 % with microfacets of GGX's distribution (Walter et al. 2007), 16 points a
/// lamp and 48 rays into the room. After light_surfels and bounce_surfels. `reflector`: `ambient`
/// comes from all sides, and with `bounce` what a ray meets besides.
void gloss_object(SurfelMap& map, const Reflector& reflector, const LampSet& lamps,
                  const VirtualObject& object, bool bounce, Crew& crew);

}  // namespace mixrig::studio

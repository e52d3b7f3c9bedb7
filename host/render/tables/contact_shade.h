// SPDX-License-Identifier: Apache-2.0
// What virtual objects hide of the ambient light near them, and of their own: found once an object,
// in a grid around it that both back ends look up (as the fields of Malmer et al. 2007).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "host/render/contract/compositor.h"
#include "host/render/contract/constants.h"

namespace mixrig::render {

/// A place of the grid: shares of the light from all sides, weighted by the cosine, that do not
/// come to a surface with its normal along each axis of the object.
struct HiddenShares {
  std::array<std::uint8_t, 4> up{};    ///< 255 = all; normal x, y, z; the fourth is not used
  std::array<std::uint8_t, 4> down{};  ///< normal -x, -y, -z
};

/// Axes of the object, metres. Along each of them kContactInside cells share the object's box, and
/// kContactOutside ones on each side grow from it with the square of their number.
struct ContactShade {
  glm::vec3 low_m{0}, high_m{0};  ///< of the object's box
  float reach_m = 0;              ///< of the grid beyond the box; at its border nothing is hidden
  glm::vec3 albedo{0};            ///< mean of the object's surface
  std::vector<HiddenShares> hidden;  ///< [z][y][x], kContactNodes along each; empty: no object
};

/// Of one object, as it is scaled. It stands on a floor, its lowest point, which it makes darker
/// too. Takes some 0.1 s for 10000 triangles; pure.
ContactShade make_contact_shade(const VirtualObject& object);

/// Whether an object of the setup has one: geometry::Light::contact, it casts shadows, and is no
/// set.
bool has_contact(const CompositorSetup& setup, const VirtualObject& object);

}  // namespace mixrig::render

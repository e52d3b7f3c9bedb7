// SPDX-License-Identifier: Apache-2.0
// Ambient light by direction: what the learned room sends to the virtual objects from each side.
#pragma once

#include <array>
#include <optional>

#include <glm/glm.hpp>

#include "host/render/contract/compositor.h"
#include "host/render/contract/constants.h"

namespace mixrig::render {

/// Light from a direction (x, y, z), in units of geometry::Light::ambient, as real spherical
/// harmonics of second order: the sum of the terms times 1; y, z, x; xy, yz, 3z^2-1, xz, x^2-y^2.
/// World axes.
using AmbientTerms = std::array<glm::vec3, kAmbientTermCount>;

/// Of the learned room, as the middle of the objects sees it: `world_from_camera` is the pose at
/// which a still background was learned. Lamps of the setup do not count, since they are light of
/// their own. From directions in which nothing was learned comes the setup's ambient light. None
/// without geometry::Light::by_direction, colour, objects, or where the room is not shown. Pure.
std::optional<AmbientTerms> make_ambient(const CompositorSetup& setup,
                                         const geometry::Pose& world_from_camera);

}  // namespace mixrig::render

// SPDX-License-Identifier: Apache-2.0
// Ambient light by direction: light that the learned room sends to the virtual objects.
#pragma once

#include <array>
#include <optional>

#include <glm/glm.hpp>

#include "host/render/contract/compositor.h"
#include "host/render/contract/constants.h"

namespace mixrig::render {

/// Light from a direction (x, y, z) in world axes, in units of geometry::Light::ambient, as real
/// spherical harmonics of second order: the sum of the terms times 1; y, z, x; xy, yz, 3z^2-1, xz,
/// x^2-y^2.
using AmbientTerms = std::array<glm::vec3, kAmbientTermCount>;

/// Ambient light of the learned room at the centre of the objects. `world_from_camera`: pose at
/// which a still background was learned. The setup's lamps are left out, since they light on their
/// own; directions in which nothing was learned have the setup's ambient light. Nullopt without
/// geometry::Light::by_direction, colour, objects, or where the room is not shown. Pure.
std::optional<AmbientTerms> make_ambient(const CompositorSetup& setup,
                                         const geometry::Pose& world_from_camera);

}  // namespace mixrig::render

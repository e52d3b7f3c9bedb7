// SPDX-License-Identifier: Apache-2.0
// Measures gaps between objects, and between objects and the room.
#pragma once

#include <optional>
#include <span>

#include "extras/people/plan/floor_map.h"
#include "extras/people/touch/contact.h"
#include "extras/people/touch/shape.h"
#include "host/math/geometry/pose.h"

namespace mixrig::touch {

/// Gap between the nearest parts of two objects, by GJK (Bullet); where they overlap, the least
/// depth over the directions of their faces. nullopt where their boxes are farther than kNear_m
/// from each other.
std::optional<Gap> shape_gap(const Shape& a, const geometry::Pose& world_from_a, const Shape& b,
                             const geometry::Pose& world_from_b);

/// Depth of the empty room's points in an object, from the deepest 20 cm^2; points are counted in
/// cells of 2 cm, of 4 cm^2 each. nullopt where there is less surface near it. Pure.
std::optional<Gap> room_gap(const Shape& shape, const geometry::Pose& world_from_object,
                            std::span<const plan::RoomPoint> room);

}  // namespace mixrig::touch

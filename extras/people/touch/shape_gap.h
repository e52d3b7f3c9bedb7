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

/// Gap between an object and points of the empty room; negative: the points lie inside it. It is
/// the largest distance among the nearest 20 cm^2 of the room, where each cell of 2 cm that holds a
/// point counts as 4 cm^2. nullopt where less of the room is near the object. Pure.
std::optional<Gap> room_gap(const Shape& shape, const geometry::Pose& world_from_object,
                            std::span<const plan::RoomPoint> room);

}  // namespace mixrig::touch

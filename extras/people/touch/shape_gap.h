// SPDX-License-Identifier: Apache-2.0
// How near objects are to each other and to the room.
#pragma once

#include <optional>
#include <span>

#include "extras/people/plan/floor_map.h"
#include "extras/people/touch/contact.h"
#include "extras/people/touch/shape.h"
#include "host/math/geometry/pose.h"

namespace mixrig::touch {

/// Between the nearest parts of two objects: GJK (Bullet); where they overlap, the least depth over
/// the directions of their faces. None where their boxes are farther than kNear_m from each other.
std::optional<Gap> shape_gap(const Shape& a, const geometry::Pose& world_from_a, const Shape& b,
                             const geometry::Pose& world_from_b);

/// How deep points of the empty room lie in an object, by cells of 2 cm: the nearest 20 cm^2, of
/// which each cell that holds a point is 4. None where there is less near it. Pure.
std::optional<Gap> room_gap(const Shape& shape, const geometry::Pose& world_from_object,
                            std::span<const plan::RoomPoint> room);

}  // namespace mixrig::touch

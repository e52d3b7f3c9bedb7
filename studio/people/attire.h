// SPDX-License-Identifier: Apache-2.0
// Clothes of a person, and carried things, in addition to the plain body.
#pragma once

#include "studio/stage/person.h"

namespace mixrig::studio {

/// Strands of 1.5 mm by 2 to 5 cm on top, sides and back of the head, the same ones at all times.
void add_strands(const Build& build, const BodyPoints& points, unsigned seed, Mesh& mesh);
/// A coat from the chest to the knees whose hem swings with the steps.
void add_coat(const Build& build, const Posture& posture, const BodyPoints& points, Mesh& mesh);
/// A stick of 12 mm in the left hand; a black bag and a chrome ball at the right one.
void add_props(const Posture& posture, const BodyPoints& points, Mesh& mesh);

}  // namespace mixrig::studio

// SPDX-License-Identifier: Apache-2.0
// The person's body and clothes in a posture.
#pragma once

#include "studio/stage/posture.h"

namespace mixrig::studio {

/// Places on a body for what it wears and carries. Index 0 is the left side.
struct BodyPoints {
  std::array<Vec3, 2> hands;   ///< middle of the palm
  Vec3 chin, ahead, left, up;  ///< of the head: chin, and its axes
  Vec3 chest_ahead, chest_up;
};
/// Adds the body in `posture` to `mesh`: torso, bent limbs, hands with fingers, shoes, head.
BodyPoints build_person(const Build& build, const Posture& posture, Mesh& mesh);

}  // namespace mixrig::studio

// SPDX-License-Identifier: Apache-2.0
// The person's body and clothes in a posture.
#pragma once

#include "host/studio/stage/posture.h"

namespace mixrig::studio {

/// Adds the body in `posture` to `mesh`: torso, bent limbs, hands with fingers, shoes, head.
void build_person(const Build& build, const Posture& posture, Mesh& mesh);

}  // namespace mixrig::studio

// SPDX-License-Identifier: Apache-2.0
// Pass motion: blurs virtual things by the camera's motion during the exposure (frame_motion.h).
#pragma once

#include "hal/base/parallel.h"
#include "host/render/cpu/virtual/virtual.h"
#include "host/render/frame/frame_motion.h"

namespace mixrig::render::cpu {

/// Blurs colour and coverage of `from` into `to`, whose images of coverage, w and colour have the
/// view's size. A covered pixel moves by its own depth. Another pixel takes the depth of the
/// nearest object that its path meets, with the path computed at the nearest depth of all objects.
/// Allocates nothing.
void blur_by_motion(Crew& crew, const MotionParams& params, const VirtualLayer& from,
                    VirtualLayer& to);

}  // namespace mixrig::render::cpu

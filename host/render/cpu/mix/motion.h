// SPDX-License-Identifier: Apache-2.0
// Pass motion: virtual things blurred along their way while the plate was exposed
// (frame_motion.h).
#pragma once

#include "hal/base/parallel.h"
#include "host/render/cpu/virtual/virtual.h"
#include "host/render/frame/frame_motion.h"

namespace mixrig::render::cpu {

/// Blurs colour and coverage of `from` into `to`, whose images of coverage, w and colour have the
/// view's size. A pixel moves as its own depth does; one that no object covers as the nearest that
/// its way, at the nearest depth of all, meets, and is as near. Allocates nothing.
void blur_by_motion(Crew& crew, const MotionParams& params, const VirtualLayer& from,
                    VirtualLayer& to);

}  // namespace mixrig::render::cpu

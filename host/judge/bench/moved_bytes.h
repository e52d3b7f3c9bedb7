// SPDX-License-Identifier: Apache-2.0
// Least memory traffic of the cpu back end.
#pragma once

#include "hal/base/image.h"
#include "host/render/contract/compositor.h"

namespace mixrig::bench {

/// Bytes that a stage of a still frame with all images of kComposite must read and write: each
/// image once in each pass that needs all of it. 0 for stages that a still frame leaves out.
double moved_bytes(render::Stage stage, Size view, Size tof);
/// Sum of moved_bytes() over all stages.
double moved_bytes(Size view, Size tof);

}  // namespace mixrig::bench

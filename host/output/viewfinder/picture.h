// SPDX-License-Identifier: Apache-2.0
// Converts a view of a composite into a picture for a screen.
#pragma once

#include "hal/base/image.h"
#include "host/output/sink/composite_sink.h"
#include "host/output/sink/views.h"
#include "host/render/contract/compositor.h"

namespace mixrig::viewfinder {

/// Views that the viewfinder shows by keys 1 to 6.
using output::kViews;
using output::View;

/// Image of the compositor that a view needs. The plate needs none; it asks for the matte, which
/// every frame makes.
render::OutputMask images_of(View view);

/// Depth range of the colours, as in contact sheets; black is unknown.
struct DepthColors {
  float near_m = 0.5F, far_m = 6;
};

/// Draws a view into `picture`, in the size of its image. Returns false, leaving `picture`
/// unchanged, if the composite does not hold the image in host memory, as for a frame or two after
/// a change of views. Allocates only when the size changes.
bool draw_view(const output::Composite& composite, View view, const DepthColors& depth,
               Image<Rgbx8>& picture);

}  // namespace mixrig::viewfinder

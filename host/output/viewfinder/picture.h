// SPDX-License-Identifier: Apache-2.0
// The picture of a view of a composite, as a screen takes it.
#pragma once

#include "hal/base/image.h"
#include "host/output/sink/composite_sink.h"
#include "host/output/sink/views.h"
#include "host/render/contract/compositor.h"

namespace mixrig::viewfinder {

/// What the viewfinder shows; keys 1 to 6.
using output::kViews;
using output::View;

/// The image of the compositor that a view shows. The plate needs none; it asks for the matte,
/// which every frame makes.
render::OutputMask images_of(View view);

/// Depth is drawn from near to far as in contact sheets, black where it is unknown.
struct DepthColors {
  float near_m = 0.5F, far_m = 6;
};

/// Makes `picture` that of the view, in the size of its image. False where the composite does not
/// hold the image in its own memory, which is so for a frame or two after a change of views;
/// `picture` is as before. Allocates only when the size changes.
bool draw_view(const output::Composite& composite, View view, const DepthColors& depth,
               Image<Rgbx8>& picture);

}  // namespace mixrig::viewfinder

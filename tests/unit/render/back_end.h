// SPDX-License-Identifier: Apache-2.0
// The back end that a program of tests is of: render_test links the cpu's, gl_test that of gles.
#pragma once

#include <memory>

#include "host/render/contract/compositor.h"
#include "host/render/tables/prepare.h"

namespace mixrig::test {

std::unique_ptr<render::Compositor> make_compositor(const render::CompositorSetup& setup,
                                                    int threads);

/// What pass correct makes of a depth picture.
struct CorrectedDepth {
  Image<float> z_m;
  Image<int> links;  ///< 1 right, 2 down, 4 down and right, 8 down and left
};
CorrectedDepth correct_depth(const render::Tables& tables, const Image<float>& depth_m);

/// Inverse depth in the view.
struct WarpedDepth {
  Image<float> w;
  Image<bool> cut;  ///< drawn by a cell of two surfaces
};
WarpedDepth warp_depth(const render::Tables& tables, const Image<float>& depth_m, int threads);

/// Matte of a plate in linear light. `w` is the view's inverse depth, negative where a cut cell drew
/// it, and becomes the depth of people where they are.
Image<std::uint8_t> key_people(const render::CompositorSetup& setup, const Image<Rgbf>& plate,
                               Image<float>& w);

}  // namespace mixrig::test

// SPDX-License-Identifier: Apache-2.0
// The passes of the back end under test: render_test links those of cpu, gl_test those of gles.
#pragma once

#include <memory>

#include "host/render/contract/compositor.h"
#include "host/render/tables/prepare.h"

namespace mixrig::test {

std::unique_ptr<render::Compositor> make_compositor(const render::CompositorSetup& setup,
                                                    int threads);

/// Result of the pass `correct` for one depth picture.
struct CorrectedDepth {
  Image<float> z_m;
  Image<int> links;  ///< 1 right, 2 down, 4 down and right, 8 down and left
};
CorrectedDepth correct_depth(const render::Tables& tables, const Image<float>& depth_m);

/// Result of the warp: inverse depth in the view, in 1/m.
struct WarpedDepth {
  Image<float> w;
  Image<bool> cut;  ///< pixel was drawn by a cell between two surfaces
};
WarpedDepth warp_depth(const render::Tables& tables, const Image<float>& depth_m, int threads);

/// Matte of a plate in linear light. `w` is the view's inverse depth, negative where a cut cell drew
/// it, and becomes the depth of people where they are.
Image<std::uint8_t> key_people(const render::CompositorSetup& setup, const Image<Rgbf>& plate,
                               Image<float>& w);

}  // namespace mixrig::test

// SPDX-License-Identifier: Apache-2.0
#include "host/output/viewfinder/picture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "hal/base/srgb.h"
#include "host/output/report/picture.h"

namespace mixrig::viewfinder {
namespace {

using Ramp = std::array<Rgbx8, 256>;

Rgbx8 opaque(Rgb8 p) { return {p.r, p.g, p.b, 255}; }

/// Colours of depth from near to far.
const Ramp& depth_ramp() {
  static const Ramp ramp = [] {
    Ramp made;
    for (std::size_t i = 0; i < made.size(); ++i)
      made[i] = opaque(report::depth_color(static_cast<float>(i) / 255));
    return made;
  }();
  return ramp;
}

/// Greys of light 0..1.
const Ramp& light_ramp() {
  static const Ramp ramp = [] {
    Ramp made;
    for (std::size_t i = 0; i < made.size(); ++i) {
      const auto grey = static_cast<std::uint8_t>(
          std::lround(255 * srgb_from_linear(static_cast<float>(i) / 255)));
      made[i] = {grey, grey, grey, 255};
    }
    return made;
  }();
  return ramp;
}

const Rgbx8& of_ramp(const Ramp& ramp, float share) {
  return ramp[static_cast<std::size_t>(255 * std::clamp(share, 0.0F, 1.0F) + 0.5F)];
}

template <typename In, typename PixelOf>
bool fill(ImageView<const In> in, Image<Rgbx8>& out, PixelOf&& pixel_of) {
  if (in.empty()) return false;
  if (out.size() != in.size) out.reset(in.size);
  for (int y = 0; y < in.size.height; ++y)
    std::transform(in.row(y), in.row(y) + in.size.width, out.row(y), pixel_of);
  return true;
}

Rgbx8 grey(std::uint8_t byte) { return {byte, byte, byte, 255}; }

bool draw_depth(ImageView<const float> depth_m, const DepthColors& colors, Image<Rgbx8>& picture) {
  const Ramp& ramp = depth_ramp();
  const float scale = 1 / std::max(colors.far_m - colors.near_m, 1e-3F);
  return fill(depth_m, picture, [&](float z_m) {
    return z_m > 0 && std::isfinite(z_m) ? of_ramp(ramp, (z_m - colors.near_m) * scale)
                                         : Rgbx8{0, 0, 0, 255};
  });
}

}  // namespace

render::OutputMask images_of(View view) {
  switch (view) {
    case View::kComposite:
      return render::kColor;
    case View::kKey:
      return render::kState;
    case View::kDepth:
      return render::kMixedDepth;
    case View::kLight:
      return render::kLight;
    case View::kPlate:
    case View::kMatte:
      break;
  }
  return render::kMatte;
}

bool draw_view(const output::Composite& composite, View view, const DepthColors& depth,
               Image<Rgbx8>& picture) {
  const render::FrameOutput& images = composite.images;
  if (view == View::kPlate) return fill(plate_of(*composite.capture).view(), picture, opaque);
  if ((images.wanted & images_of(view)) == 0) return false;
  switch (view) {
    case View::kComposite:
      return fill(images.color.view(), picture, opaque);
    case View::kKey:
      return fill(images.state.view(), picture,
                  [](std::uint8_t state) { return opaque(report::key_color(state)); });
    case View::kDepth:
      return draw_depth(images.mixed_depth_m.view(), depth, picture);
    case View::kLight: {
      const Ramp& ramp = light_ramp();
      return fill(images.light.view(), picture, [&](float light) { return of_ramp(ramp, light); });
    }
    case View::kMatte:
      return fill(images.matte.view(), picture, grey);
    case View::kPlate:
      break;
  }
  return false;
}

}  // namespace mixrig::viewfinder

// SPDX-License-Identifier: Apache-2.0
#include "host/render/frame/focus_discs.h"

#include <algorithm>
#include <cmath>

namespace mixrig::render {

float focus_cover(float d, float r) { return std::clamp(r + 0.5F - d, 0.0F, 1.0F); }

std::vector<float> focus_disc_areas(int most_radius) {
  std::vector<float> area(static_cast<std::size_t>((most_radius + 1) * kFocusAreaSteps + 1));
  for (std::size_t i = 0; i < area.size(); ++i) {
    const float r = static_cast<float>(i) / kFocusAreaSteps;
    const int reach = static_cast<int>(std::ceil(r)) + 1;
    for (int y = -reach; y <= reach; ++y)
      for (int x = -reach; x <= reach; ++x)
        area[i] += focus_cover(std::hypot(static_cast<float>(x), static_cast<float>(y)), r);
    area[i] = std::max(area[i], 1.0F);
  }
  return area;
}

int focus_margin(const Focus& focus) {
  return static_cast<int>(std::ceil(0.5F * focus.most_blur_px)) + 1;
}

Focus focus_of(const CompositorSetup& setup, const FrameInput& input) {
  Focus focus = *setup.focus;
  if (!input.focus_pixel) return focus;
  focus.distance_m = 0;
  focus.pixel = input.focus_pixel;
  return focus;
}

}  // namespace mixrig::render

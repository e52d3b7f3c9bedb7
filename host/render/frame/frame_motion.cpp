// SPDX-License-Identifier: Apache-2.0
#include "host/render/frame/frame_motion.h"

namespace mixrig::render {

MotionParams motion_params(const std::optional<CameraMotion>& motion, const geometry::Pinhole& view,
                           const FrameParams& frame) {
  MotionParams params;
  const Rect& r = frame.virtual_rect;
  if (!motion || r.empty()) return params;
  params.motion = *motion;
  params.focal_px = {view.fx_px, view.fy_px};
  params.center_px = {view.cx_px, view.cy_px};
  params.nearest_w = frame.nearest_virtual_w;
  float longest = 0;
  for (const int x : {r.x0, r.x1})
    for (const int y : {r.y0, r.y1})
      for (const float w : {0.0F, params.nearest_w})
        longest = std::max(longest, glm::length(motion_px(params, glm::vec2(x, y), w)));
  if (longest < kLeastMotionPx) return params;
  const int reach = static_cast<int>(std::ceil(0.5F * longest)) + 1;
  const Size size = view.size_px;
  params.rect = {std::max(r.x0 - reach, 0), std::max(r.y0 - reach, 0),
                 std::min(r.x1 + reach, size.width), std::min(r.y1 + reach, size.height)};
  return params;
}

}  // namespace mixrig::render

// SPDX-License-Identifier: Apache-2.0
// Motion of virtual objects in the view while a plate is exposed. Shared by both back ends.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include <glm/glm.hpp>

#include "host/render/contract/constants.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render {

/// Parameters of pass motion for one frame.
struct MotionParams {
  CameraMotion motion;
  glm::vec2 focal_px{1}, center_px{0};  ///< of the view
  float nearest_w = 0;                  ///< nearest virtual object, 1/m
  Rect rect;                            ///< view pixels that blurred objects may touch
  bool blurs() const { return !rect.empty(); }
};

/// Displacement in pixels over the exposure of a still point that is seen at `px` with w = 1/z, to
/// first order in the motion (Longuet-Higgins and Prazdny 1980). At most kMostMotionPx long.
inline glm::vec2 motion_px(const MotionParams& p, const glm::vec2& px, float w) {
  const glm::vec2 ray = (px - p.center_px) / p.focal_px;
  const glm::vec3 moves = glm::cross(p.motion.turn_rad, glm::vec3(ray, 1)) + w * p.motion.shift_m;
  const glm::vec2 way = p.focal_px * (glm::vec2(moves) - ray * moves.z);
  const float length = std::sqrt(glm::dot(way, way));
  return length > kMostMotionPx ? way * (kMostMotionPx / length) : way;
}

/// Number of samples over the exposure for a displacement of this length, at least one. Sample i
/// lies at (i + 1/2) / samples - 1/2 of the displacement from the middle.
inline int motion_samples(float length_px) {
  return std::clamp(static_cast<int>(std::ceil(length_px)) + 1, 1, kMostMotionSamples);
}

/// Parameters without blur (empty rect) where no motion is known, or where no corner of the
/// objects' rectangle moves by kLeastMotionPx. Pure.
MotionParams motion_params(const std::optional<CameraMotion>& motion, const geometry::Pinhole& view,
                           const FrameParams& frame);

}  // namespace mixrig::render

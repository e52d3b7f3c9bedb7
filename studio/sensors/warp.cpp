// SPDX-License-Identifier: Apache-2.0
// A picture as another place of the camera would see it.
#include "studio/sensors/warp.h"

#include <algorithm>

namespace mixrig::studio {

Eigen::Vector2f seen_from(const RayGrid& rays, const Optics& optics,
                          const geometry::Pose& mid_from_then, const Eigen::Vector2f& px,
                          float z_m) {
  const Eigen::Vector2f ideal = rays.at(px.x(), px.y());
  const double z = std::min(z_m, 1e6F);
  const Eigen::Vector3d then(z * static_cast<double>(ideal.x()), z * static_cast<double>(ideal.y()),
                             z);
  return project(optics, mid_from_then * then).cast<float>();
}

Rgbf sample(const Image<Rgbf>& picture, const Eigen::Vector2f& px) {
  const float u = std::clamp(px.x(), 0.0F, static_cast<float>(picture.width() - 1));
  const float v = std::clamp(px.y(), 0.0F, static_cast<float>(picture.height() - 1));
  const int x = static_cast<int>(u), y = static_cast<int>(v);
  const int right = std::min(x + 1, picture.width() - 1),
            down = std::min(y + 1, picture.height() - 1);
  const float s = u - static_cast<float>(x), t = v - static_cast<float>(y);
  const Rgbf &a = picture.at(x, y), &b = picture.at(right, y), &c = picture.at(x, down),
             &d = picture.at(right, down);
  const auto mix = [s, t](float p, float q, float r, float w) {
    return (1 - t) * ((1 - s) * p + s * q) + t * ((1 - s) * r + s * w);
  };
  return {mix(a.r, b.r, c.r, d.r), mix(a.g, b.g, c.g, d.g), mix(a.b, b.b, c.b, d.b)};
}

}  // namespace mixrig::studio

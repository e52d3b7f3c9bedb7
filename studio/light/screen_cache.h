// SPDX-License-Identifier: Apache-2.0
// Values that change slowly along a surface, kept at every n-th pixel of a camera (Ward, Rubinstein
// and Clear 1988 keep irradiance at points of the surface in the same way).
#pragma once

#include <algorithm>
#include <vector>

#include "hal/base/image.h"
#include "hal/base/parallel.h"
#include "studio/stage/mesh.h"

namespace mixrig::studio {

/// A point of a surface with its value. Value has +=, and * with a float.
template <typename Value>
struct CacheNode {
  Vec3 position = Vec3::Zero(), normal = Vec3::Zero();  ///< no normal: nothing is seen here
  Value value{};
};

template <typename Value>
class ScreenCache {
 public:
  using Node = CacheNode<Value>;

  /// Nodes are `step_px` apart and reach `margin_px` beyond a picture of `size`.
  void reset(Size size, int step_px, int margin_px) {
    step_ = step_px, margin_ = margin_px;
    columns_ = (size.width + 2 * margin_px) / step_px + 2;
    rows_ = (size.height + 2 * margin_px) / step_px + 2;
    nodes_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), {});
  }
  /// Calls fill(u_px, v_px, node) for all nodes, in parallel.
  template <typename Fill>
  void build(Crew& crew, Fill&& fill) {
    crew.rows(rows_, 1, [&](int begin, int end) {
      for (int j = begin; j < end; ++j)
        for (int i = 0; i < columns_; ++i)
          fill(static_cast<float>(i * step_ - margin_), static_cast<float>(j * step_ - margin_),
               nodes_[static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_) +
                      static_cast<std::size_t>(i)]);
    });
  }
  /// Value at a surface point that is seen at a pixel: the four nodes around it, of which those
  /// count most that lie on the same surface.
  Value at(float u_px, float v_px, const Vec3& position, const Vec3& normal) const {
    const float x = std::clamp((u_px + static_cast<float>(margin_)) / static_cast<float>(step_),
                               0.0F, static_cast<float>(columns_) - 1.001F);
    const float y = std::clamp((v_px + static_cast<float>(margin_)) / static_cast<float>(step_),
                               0.0F, static_cast<float>(rows_) - 1.001F);
    const int i = static_cast<int>(x), j = static_cast<int>(y);
    const float s = x - static_cast<float>(i), t = y - static_cast<float>(j);
    Value sum{};
    float total = 0;
    for (int k = 0; k < 4; ++k) {
      const Node& node =
          nodes_[static_cast<std::size_t>(j + k / 2) * static_cast<std::size_t>(columns_) +
                 static_cast<std::size_t>(i + k % 2)];
      if (node.normal.isZero()) continue;
      const float bilinear = (k % 2 == 1 ? s : 1 - s) * (k / 2 == 1 ? t : 1 - t) + 1e-3F;
      const float off = normal.dot(position - node.position) / kOff_m;
      const float turned = std::max(0.0F, normal.dot(node.normal));
      const float weight = bilinear * (turned * turned * turned / (1 + off * off) + 1e-4F);
      sum += node.value * weight;
      total += weight;
    }
    return total > 0 ? sum * (1 / total) : sum;
  }

  const std::vector<Node>& nodes() const { return nodes_; }

 private:
  static constexpr float kOff_m = 0.02F;  ///< from the surface, at which a node counts half

  int step_ = 1, margin_ = 0, columns_ = 0, rows_ = 0;
  std::vector<Node> nodes_;
};

/// Direction i of n within the hemisphere about `normal`, spread as the cosine: the mean over all
/// n of a function is the integral of function times cosine over pi. The same pattern everywhere,
/// so that neighbours have the same error (spiral of Vogel 1979).
Vec3 hemisphere_direction(const Vec3& normal, int i, int n);

}  // namespace mixrig::studio

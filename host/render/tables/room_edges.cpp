// SPDX-License-Identifier: Apache-2.0
#include "host/render/tables/room_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <glm/glm.hpp>

namespace mixrig::render {
namespace {

/// Neighbours form a step if their inverse depths differ by this part, and by twice as much as
/// those of the next pixels on either side.
constexpr float kStepPart = 0.03F;
/// Samples whose inverse depths differ by at most this part are one surface.
constexpr float kSamePart = 0.04F;
/// Standard deviation of colours on a surface, in square roots of linear light.
constexpr float kColorSpread = 0.05F;
/// Share of the weights that a surface needs to take a pixel, and to give depth to a pixel without
/// one.
constexpr float kMost = 0.5F, kMostOfHole = 0.7F;
/// Least confidence of a sample, at a step.
constexpr float kLeastSure = 0.05F;

struct Sample {
  float dx, dy, w, weight;
};

class RoomEdges {
 public:
  RoomEdges(const BackgroundView& background, float footprint_px)
      : depth_m_(background.depth_m),
        size_(background.depth_m.size),
        reach_px_(2 * footprint_px + 1),
        window_px_(static_cast<int>(std::ceil(3.5F * footprint_px))),
        stride_px_(std::max(1, window_px_ / 6)),
        spread_px_(1.3F * footprint_px),
        w_(size_),
        color_(size_),
        from_step_px_(size_, reach_px_) {
    for (int y = 0; y < size_.height; ++y)
      for (int x = 0; x < size_.width; ++x) {
        const float z = depth_m_.row(y)[x];
        w_.row(y)[x] = z > 0 && std::isfinite(z) ? 1 / z : 0;
        const Rgbf c = background.color.row(y)[x];
        color_.row(y)[x] =
            c.r < 0 ? glm::vec3(-1) : glm::sqrt(glm::max(glm::vec3(c.r, c.g, c.b), glm::vec3(0)));
      }
    find_steps();
  }

  Image<float> depth() {
    Image<float> out(size_);
    for (int y = 0; y < size_.height; ++y)
      for (int x = 0; x < size_.width; ++x) {
        const float z = depth_m_.row(y)[x];
        out.row(y)[x] = from_step_px_.row(y)[x] < reach_px_ ? decided(x, y, z) : z;
      }
    return out;
  }

 private:
  float w(int x, int y) const {
    return x < 0 || y < 0 || x >= size_.width || y >= size_.height ? 0 : w_.row(y)[x];
  }
  /// Whether a step lies between (x, y) and its neighbour to the right or below.
  bool is_step(int x, int y, int dx, int dy) const {
    const float a = w(x, y), b = w(x + dx, y + dy);
    if (!(a > 0) || !(b > 0)) return (a > 0) != (b > 0);
    const float step = std::abs(a - b);
    if (step < kStepPart * std::max(a, b)) return false;
    const float before = w(x - dx, y - dy), after = w(x + 2 * dx, y + 2 * dy);
    const float slope =
        std::max(before > 0 ? std::abs(a - before) : 0.0F, after > 0 ? std::abs(after - b) : 0.0F);
    return step > 2 * slope;
  }
  /// Distance of each pixel's centre from the nearest step, up to reach_px_.
  void find_steps() {
    for (int y = 0; y < size_.height; ++y)
      for (int x = 0; x < size_.width; ++x) {
        if (x + 1 < size_.width && is_step(x, y, 1, 0)) mark(x, y), mark(x + 1, y);
        if (y + 1 < size_.height && is_step(x, y, 0, 1)) mark(x, y), mark(x, y + 1);
      }
    const auto pass = [this](int x, int y, int sign) {
      constexpr std::array<std::array<int, 2>, 4> kBehind = {{{-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};
      float& at = from_step_px_.row(y)[x];
      for (const auto& [dx, dy] : kBehind) {
        const int u = x + sign * dx, v = y + sign * dy;
        if (u < 0 || v < 0 || u >= size_.width || v >= size_.height) continue;
        at = std::min(at, from_step_px_.row(v)[u] + (dx != 0 && dy != 0 ? 1.414F : 1.0F));
      }
    };
    for (int y = 0; y < size_.height; ++y)
      for (int x = 0; x < size_.width; ++x) pass(x, y, 1);
    for (int y = size_.height - 1; y >= 0; --y)
      for (int x = size_.width - 1; x >= 0; --x) pass(x, y, -1);
  }
  void mark(int x, int y) { from_step_px_.row(y)[x] = 0.5F; }

  void collect(int x, int y) {
    samples_.clear();
    const glm::vec3 own = color_.row(y)[x];
    if (own.r < 0) return;
    const float by_color = 0.5F / (kColorSpread * kColorSpread);
    const float by_distance = 0.5F / (spread_px_ * spread_px_);
    for (int v = std::max(0, y - window_px_); v <= std::min(size_.height - 1, y + window_px_);
         v += stride_px_)
      for (int u = std::max(0, x - window_px_); u <= std::min(size_.width - 1, x + window_px_);
           u += stride_px_) {
        const float at_w = w_.row(v)[u];
        const glm::vec3 c = color_.row(v)[u];
        if (!(at_w > 0) || c.r < 0) continue;
        const float dx = static_cast<float>(u - x), dy = static_cast<float>(v - y);
        const glm::vec3 off = c - own;
        const float far = by_color * glm::dot(off, off) + by_distance * (dx * dx + dy * dy);
        if (far > 8) continue;
        float near = 1 - far / 8;  // to the eighth power: exp(-far), as good as that and cheaper
        near *= near, near *= near, near *= near;
        const float sure = from_step_px_.row(v)[u] / reach_px_;
        samples_.push_back({dx, dy, at_w, (kLeastSure + sure * sure) * near});
      }
  }

  float decided(int x, int y, float z) {
    collect(x, y);
    if (samples_.size() < 6) return z;
    std::sort(samples_.begin(), samples_.end(),
              [](const Sample& a, const Sample& b) { return a.w < b.w; });
    double all = 0, inside = 0, best = 0;
    std::size_t first = 0, best_first = 0, best_end = 0;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      all += samples_[i].weight, inside += samples_[i].weight;
      while (samples_[i].w - samples_[first].w > kSamePart * samples_[i].w)
        inside -= samples_[first++].weight;
      if (inside > best) best = inside, best_first = first, best_end = i + 1;
    }
    if (best < (z > 0 ? kMost : kMostOfHole) * all) return z;
    const float w = plane_at(best_first, best_end);
    const float low = samples_[best_first].w, high = samples_[best_end - 1].w;
    return 1 / std::clamp(w, low - kSamePart * low, high + kSamePart * high);
  }
  /// Inverse depth at the centre of the plane through the samples; slopes are damped.
  float plane_at(std::size_t first, std::size_t end) const {
    glm::dmat3 normal(0);
    glm::dvec3 right(0);
    for (std::size_t i = first; i < end; ++i) {
      const Sample& s = samples_[i];
      const glm::dvec3 row(1, s.dx, s.dy);
      normal += static_cast<double>(s.weight) * glm::outerProduct(row, row);
      right += static_cast<double>(s.weight * s.w) * row;
    }
    const double damp = 0.02 * normal[0][0] * spread_px_ * spread_px_;
    normal[1][1] += damp, normal[2][2] += damp;
    return static_cast<float>((glm::inverse(normal) * right).x);
  }

  const ImageView<const float> depth_m_;
  const Size size_;
  const float reach_px_;
  const int window_px_, stride_px_;
  const float spread_px_;
  Image<float> w_;
  Image<glm::vec3> color_;
  Image<float> from_step_px_;
  std::vector<Sample> samples_;
};

}  // namespace

Image<float> depth_at_color_edges(const BackgroundView& background, float footprint_px) {
  if (background.color.empty() || background.depth_m.empty()) return {};
  return RoomEdges(background, footprint_px).depth();
}

}  // namespace mixrig::render

// SPDX-License-Identifier: Apache-2.0
#include "host/render/tables/contact_shade.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "hal/base/image.h"
#include "hal/base/srgb.h"

namespace mixrig::render {
namespace {

constexpr int kNodes = kContactNodes;
/// Directions that are sampled: fewer for large meshes, which are drawn once for each direction.
constexpr int kMostLooks = 128, kFewestLooks = 32;
constexpr std::size_t kMostDrawn = 4000000;  // triangles
constexpr int kSilhouetteTexels = 128;
constexpr float kSelfTexels = 1.5F;  ///< surfaces nearer than this to a place do not hide it
/// A place hidden in this share of the directions lies within the object.
constexpr float kInsideShare = 0.97F;
constexpr int kAlbedoTexels = 64;  ///< texels sampled along each side of a texture for its mean

using Shares = std::array<float, 6>;  ///< for normals x, y, z, -x, -y, -z

/// Triangles of an object in its axes, metres.
struct Solid {
  std::vector<glm::vec3> corners_m;  ///< three a triangle
  glm::vec3 low_m{std::numeric_limits<float>::max()}, high_m{-low_m};
};

Solid solid_of(const VirtualObject& object) {
  Solid solid;
  for (const MeshView& mesh : object.meshes)
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
      for (std::size_t k = 0; k < 3; ++k) {
        const glm::vec3 p =
            static_cast<float>(object.scale) * mesh.positions_m[mesh.indices[i + k]];
        solid.corners_m.push_back(p);
        solid.low_m = glm::min(solid.low_m, p), solid.high_m = glm::max(solid.high_m, p);
      }
  return solid;
}

/// Mean diffuse albedo of a mesh over its whole texture.
glm::vec3 mean_albedo(const MeshView& mesh) {
  const glm::vec3 base = (1 - mesh.gloss.metallic) * mesh.base_color;
  if (mesh.texture.empty() || mesh.uv.empty()) return base;
  const auto& linear = linear_of_srgb_bytes();
  const Size size = mesh.texture.size;
  const int every = std::max(1, std::max(size.width, size.height) / kAlbedoTexels);
  glm::vec3 sum(0);
  float count = 0;
  for (int y = 0; y < size.height; y += every)
    for (int x = 0; x < size.width; x += every) {
      const Rgb8 c = mesh.texture.row(y)[x];
      sum += glm::vec3(linear[c.r], linear[c.g], linear[c.b]), count += 1;
    }
  return base * sum / count;
}

/// Mean diffuse albedo of an object, weighted by the area of its triangles.
glm::vec3 mean_albedo(const VirtualObject& object) {
  glm::vec3 sum(0);
  float area = 1e-12F;
  for (const MeshView& mesh : object.meshes) {
    float own = 0;
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
      const auto at = [&](std::size_t k) { return mesh.positions_m[mesh.indices[i + k]]; };
      own += glm::length(glm::cross(at(1) - at(0), at(2) - at(0)));
    }
    sum += own * mean_albedo(mesh), area += own;
  }
  return sum / area;
}

/// Direction i of n, spread evenly over the sphere.
glm::vec3 direction_of(int i, int n) {
  const float z = 1 - (2 * static_cast<float>(i) + 1) / static_cast<float>(n);
  const float turn = 2.39996323F * static_cast<float>(i), across = std::sqrt(1 - z * z);
  return {across * std::cos(turn), across * std::sin(turn), z};
}

/// Height map of a solid along a direction: how far it reaches on each line along that direction.
class Silhouette {
 public:
  Silhouette(const Solid& solid, const glm::vec3& along)
      : farthest_m_({kSilhouetteTexels, kSilhouetteTexels}) {
    const glm::vec3 other = std::abs(along.z) < 0.7F ? glm::vec3(0, 0, 1) : glm::vec3(1, 0, 0);
    along_ = along, x_ = glm::normalize(glm::cross(other, along)), y_ = glm::cross(along, x_);
    middle_m_ = 0.5F * (solid.low_m + solid.high_m);
    const float radius_m = std::max(0.5F * glm::distance(solid.low_m, solid.high_m), 1e-4F);
    per_m_ = (kMiddle - 1) / radius_m;
    farthest_m_.fill(-std::numeric_limits<float>::max());
    for (std::size_t i = 0; i < solid.corners_m.size(); i += 3)
      draw(place(solid.corners_m[i]), place(solid.corners_m[i + 1]), place(solid.corners_m[i + 2]));
  }
  const glm::vec3& along() const { return along_; }
  /// Whether a ray from a point along the direction meets the solid.
  bool meets(const glm::vec3& point_m) const {
    const glm::vec3 at = place(point_m);
    const int u = static_cast<int>(std::lround(at.x)), v = static_cast<int>(std::lround(at.y));
    if (u < 0 || v < 0 || u >= kSilhouetteTexels || v >= kSilhouetteTexels) return false;
    return farthest_m_.row(v)[u] > at.z + kSelfTexels / per_m_;
  }

 private:
  static constexpr float kMiddle = 0.5F * (kSilhouetteTexels - 1);

  /// Texel coordinates (x, y) across the direction, and metres along it.
  glm::vec3 place(const glm::vec3& p) const {
    const glm::vec3 d = p - middle_m_;
    return {per_m_ * glm::dot(d, x_) + kMiddle, per_m_ * glm::dot(d, y_) + kMiddle,
            glm::dot(d, along_)};
  }
  void draw(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const auto cross = [](const glm::vec2& p, const glm::vec2& q) { return p.x * q.y - p.y * q.x; };
    const float area = cross(b - a, c - a);
    if (area == 0) return;
    const glm::vec3 low = glm::min(a, glm::min(b, c)), high = glm::max(a, glm::max(b, c));
    for (int v = static_cast<int>(std::ceil(low.y)); v <= static_cast<int>(high.y); ++v)
      for (int u = static_cast<int>(std::ceil(low.x)); u <= static_cast<int>(high.x); ++u) {
        const glm::vec2 p(u, v);
        const float sb = cross(p - glm::vec2(a), c - a) / area,
                    sc = cross(b - a, p - glm::vec2(a)) / area, sa = 1 - sb - sc;
        if (sa < 0 || sb < 0 || sc < 0) continue;
        float& farthest = farthest_m_.row(v)[u];
        farthest = std::max(farthest, sa * a.z + sb * b.z + sc * c.z);
      }
  }

  Image<float> farthest_m_;
  glm::vec3 along_, x_, y_, middle_m_;
  float per_m_ = 1;
};

/// Coordinate of node i along an axis, metres.
float node_m(int i, float low_m, float high_m, float reach_m) {
  const auto beyond = [&](int steps) {
    const float part = static_cast<float>(steps) / kContactOutside;
    return reach_m * part * part;
  };
  if (i < kContactOutside) return low_m - beyond(kContactOutside - i);
  const int last = kContactOutside + kContactInside;
  if (i > last) return high_m + beyond(i - last);
  return low_m + (high_m - low_m) * static_cast<float>(i - kContactOutside) / kContactInside;
}

/// Shares of hidden light at each node, summed over directions.
class ContactGrid {
 public:
  explicit ContactGrid(const Solid& solid, float reach_m)
      : sums_(kCount), hidden_(kCount), solid_(solid) {
    for (int axis = 0; axis < 3; ++axis)
      for (int i = 0; i < kNodes; ++i)
        at_m_[axis][static_cast<std::size_t>(i)] =
            node_m(i, solid.low_m[axis], solid.high_m[axis], reach_m);
  }

  void look_all() {
    const int looks =
        static_cast<int>(std::clamp(kMostDrawn / (solid_.corners_m.size() / 3 + 1),
                                    std::size_t{kFewestLooks}, std::size_t{kMostLooks}));
    std::vector<Silhouette> seen;
    for (int i = 0; i < looks; ++i) seen.emplace_back(solid_, direction_of(i, looks));
    // The floor's layer comes first: nodes above it look up what the floor lacks of its light.
    std::array<int, kNodes> order{};
    order[0] = kContactOutside;
    for (int k = 1, z = 0; z < kNodes; ++z)
      if (z != kContactOutside) order[static_cast<std::size_t>(k++)] = z;
    for (const int z : order)
      for (int y = 0; y < kNodes; ++y)
        for (int x = 0; x < kNodes; ++x) look({x, y, z}, seen);
    fill_inside();
  }

  HiddenShares shares(int index, bool at_border) const {
    HiddenShares out;
    if (at_border) return out;
    const Shares& s = sums_[static_cast<std::size_t>(index)];
    for (std::size_t k = 0; k < 3; ++k) out.up[k] = to_byte(s[k]), out.down[k] = to_byte(s[k + 3]);
    return out;
  }
  static int index_of(const glm::ivec3& n) { return (n.z * kNodes + n.y) * kNodes + n.x; }

 private:
  static constexpr std::size_t kCount = std::size_t{kNodes} * kNodes * kNodes;

  static std::uint8_t to_byte(float share) {
    return static_cast<std::uint8_t>(255 * std::clamp(share, 0.0F, 1.0F) + 0.5F);
  }
  glm::vec3 point(const glm::ivec3& n) const {
    return {at_m_[0][static_cast<std::size_t>(n.x)], at_m_[1][static_cast<std::size_t>(n.y)],
            at_m_[2][static_cast<std::size_t>(n.z)]};
  }
  /// Share that the floor lacks of its light where a ray from `p` meets it, by the nearest node.
  float floor_lacks(const glm::vec3& p, const glm::vec3& along) const {
    const float way = (solid_.low_m.z - p.z) / along.z;
    const auto nearest = [&](int axis) {
      const auto& line = at_m_[static_cast<std::size_t>(axis)];
      const float at = p[axis] + way * along[axis];
      const auto next = std::lower_bound(line.begin(), line.end(), at) - line.begin();
      if (next == 0 || next == kNodes) return -1;
      const auto i = static_cast<std::size_t>(next);
      return static_cast<int>(line[i] - at < at - line[i - 1] ? next : next - 1);
    };
    const int x = nearest(0), y = nearest(1);
    if (x < 0 || y < 0) return 0;
    return sums_[static_cast<std::size_t>(index_of({x, y, kContactOutside}))][2];
  }
  void look(const glm::ivec3& node, const std::vector<Silhouette>& seen) {
    const glm::vec3 p = point(node);
    const bool above = node.z > kContactOutside;
    const auto index = static_cast<std::size_t>(index_of(node));
    Shares weights{}, sums{};
    float hidden = 0;
    for (const Silhouette& of : seen) {
      const glm::vec3& d = of.along();
      const bool met = of.meets(p);
      hidden += met ? 1.0F : 0.0F;
      const float lacks = met ? 1 : above && d.z < 0 ? floor_lacks(p, d) : 0;
      for (int k = 0; k < 3; ++k) {
        const auto side = static_cast<std::size_t>(d[k] > 0 ? k : k + 3);
        weights[side] += std::abs(d[k]), sums[side] += lacks * std::abs(d[k]);
      }
    }
    hidden_[index] = hidden / static_cast<float>(seen.size());
    for (std::size_t k = 0; k < sums.size(); ++k) sums_[index][k] = sums[k] / weights[k];
  }
  /// Nodes within the object take the mean of their outside neighbours, so that the object's
  /// surface, which lies between nodes, is not darkened.
  void fill_inside() {
    for (bool any = true; any;) {
      any = false;
      std::vector<std::pair<std::size_t, Shares>> found;
      for (int z = 1; z + 1 < kNodes; ++z)
        for (int y = 1; y + 1 < kNodes; ++y)
          for (int x = 1; x + 1 < kNodes; ++x)
            if (const auto mean = mean_outside({x, y, z}))
              found.emplace_back(static_cast<std::size_t>(index_of({x, y, z})), *mean);
      for (const auto& [index, mean] : found) sums_[index] = mean, hidden_[index] = 0, any = true;
    }
  }
  std::optional<Shares> mean_outside(const glm::ivec3& node) const {
    if (hidden_[static_cast<std::size_t>(index_of(node))] < kInsideShare) return {};
    Shares sum{};
    float count = 0;
    for (const glm::ivec3 step : {glm::ivec3(1, 0, 0), glm::ivec3(0, 1, 0), glm::ivec3(0, 0, 1)})
      for (const glm::ivec3 next : {node + step, node - step}) {
        const auto index = static_cast<std::size_t>(index_of(next));
        if (hidden_[index] >= kInsideShare) continue;
        for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += sums_[index][k];
        count += 1;
      }
    if (count == 0) return {};
    for (float& s : sum) s /= count;
    return sum;
  }

  std::vector<Shares> sums_;
  std::vector<float> hidden_;  ///< share of the directions that are hidden
  std::array<std::array<float, kNodes>, 3> at_m_{};
  const Solid& solid_;
};

}  // namespace

bool has_contact(const CompositorSetup& setup, const VirtualObject& object) {
  return setup.light.contact && object.casts_shadow && !object.in_set && !object.meshes.empty();
}

ContactShade make_contact_shade(const VirtualObject& object) {
  ContactShade shade;
  const Solid solid = solid_of(object);
  if (solid.corners_m.empty()) return shade;
  const glm::vec3 size_m = solid.high_m - solid.low_m;
  shade.low_m = solid.low_m, shade.high_m = solid.high_m;
  shade.reach_m = std::max({size_m.x, size_m.y, size_m.z, 1e-3F});
  shade.albedo = mean_albedo(object);
  ContactGrid grid(solid, shade.reach_m);
  grid.look_all();
  shade.hidden.reserve(std::size_t{kNodes} * kNodes * kNodes);
  for (int z = 0; z < kNodes; ++z)
    for (int y = 0; y < kNodes; ++y)
      for (int x = 0; x < kNodes; ++x) {
        const int least = std::min({x, y, z}), most = std::max({x, y, z});
        shade.hidden.push_back(
            grid.shares(ContactGrid::index_of({x, y, z}), least == 0 || most == kNodes - 1));
      }
  return shade;
}

}  // namespace mixrig::render

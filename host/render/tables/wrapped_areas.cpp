// SPDX-License-Identifier: Apache-2.0
#include "host/render/tables/wrapped_areas.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Dense>

#include "hal/base/order_statistics.h"
#include "host/math/geometry/linear.h"

namespace mixrig::render {
namespace {

/// Neighbouring depths within this part of each other are one surface.
constexpr float kJoinedPart = 0.06F;
/// A pixel behind a border is farther by at least this part.
constexpr float kBehindPart = 0.1F;
constexpr double kLeastOfPicture = 0.002, kMostOfPicture = 0.5;
constexpr double kLeastBehind = 0.8;  ///< share of the border that has something behind it
/// Least noise over squared depth of a wrapped area, relative to the picture's median.
constexpr float kWrappedNoise = 5;
/// The picture's width over this is the widest strip without depth that is looked across.
constexpr int kStripOfWidth = 64;
constexpr int kFits = 4;

/// A pixel behind the border of an area.
struct Behind {
  double x_px, y_px, w;
};

struct AreaEdge {
  int pixels = 0;            ///< pixels of the border
  bool leaves_view = false;  ///< the area touches the picture's border
  std::vector<Behind> behind;
  std::vector<float> noise;
};

/// Robust fit of inverse depth over the picture, (1, x, y) . plane: samples that are off by more
/// than twice the median are left out of the next fit.
Eigen::Vector3d plane_behind(const std::vector<Behind>& all) {
  const auto row = [](const Behind& b) { return Eigen::Vector3d(1, b.x_px, b.y_px); };
  Eigen::Vector3d plane = Eigen::Vector3d::Zero();
  double limit = std::numeric_limits<double>::max();
  for (int fit = 0; fit < kFits; ++fit) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const Behind& b : all) {
      if (fit > 0 && std::abs(row(b).dot(plane) - b.w) > limit) continue;
      normal += row(b) * row(b).transpose();
      right += b.w * row(b);
    }
    plane = geometry::SymmetricSolver<3>(normal).solve(right);
    std::vector<double> off;
    for (const Behind& b : all) off.push_back(std::abs(row(b).dot(plane) - b.w));
    limit = 2 * upper_median_in_place(std::span(off));
  }
  return plane;
}

class Areas {
 public:
  Areas(ImageView<const float> depth_m, ImageView<const float> sigma_m)
      : depth_m_(depth_m),
        sigma_m_(sigma_m),
        size_(depth_m.size),
        strip_px_(std::max(2, size_.width / kStripOfWidth)),
        parent_(static_cast<std::size_t>(size_.area())) {
    std::iota(parent_.begin(), parent_.end(), 0);
    for (int y = 0; y < size_.height; ++y)
      for (int x = 0; x < size_.width; ++x) {
        if (x + 1 == size_.width || y + 1 == size_.height || !is_one(x, y)) continue;
        for (const int i : {at(x + 1, y), at(x, y + 1), at(x + 1, y + 1)}) join(at(x, y), i);
      }
  }

  Image<float> depth_without() {
    median_noise_ = find_median_noise();
    Image<float> out(size_);
    for (int y = 0; y < size_.height; ++y) std::copy_n(depth_m_.row(y), size_.width, out.row(y));
    for (const int root : roots())
      if (const auto plane = plane_of_wrapped(root)) fill(root, *plane, out);
    return out;
  }

 private:
  /// Whether the square of four pixels from (x, y) on shows one surface. Areas are joined by such
  /// squares, so that single pixels between two depths connect nothing.
  bool is_one(int x, int y) const {
    const auto [low, high] = std::minmax({z(x, y), z(x + 1, y), z(x, y + 1), z(x + 1, y + 1)});
    return low > 0 && high - low <= kJoinedPart * low;
  }
  float z(int x, int y) const { return depth_m_.row(y)[x]; }
  float noise(int x, int y) const { return sigma_m_.row(y)[x] / (z(x, y) * z(x, y)); }
  int at(int x, int y) const { return y * size_.width + x; }
  int root_of(int i) {
    int* parent = parent_.data();
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  }
  void join(int a, int b) {
    a = root_of(a), b = root_of(b);
    parent_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }
  /// Roots of the areas whose size fits a mirror.
  std::vector<int> roots() {
    std::vector<int> count(parent_.size());
    for (std::size_t i = 0; i < parent_.size(); ++i)
      ++count[static_cast<std::size_t>(root_of(static_cast<int>(i)))];
    const double all = static_cast<double>(size_.area());
    std::vector<int> roots;
    for (std::size_t i = 0; i < count.size(); ++i)
      if (count[i] >= kLeastOfPicture * all && count[i] <= kMostOfPicture * all)
        roots.push_back(static_cast<int>(i));
    return roots;
  }
  /// The plane behind an area, if the area is wrapped.
  std::optional<Eigen::Vector3d> plane_of_wrapped(int root) {
    AreaEdge edge;
    for (int y = 0; y < size_.height; ++y)
      for (int x = 0; x < size_.width; ++x) {
        if (!(z(x, y) > 0) || root_of(at(x, y)) != root) continue;
        edge.noise.push_back(noise(x, y));
        look(x, y, 1, 0, root, edge), look(x, y, -1, 0, root, edge);
        look(x, y, 0, 1, root, edge), look(x, y, 0, -1, root, edge);
      }
    if (edge.leaves_view || static_cast<double>(edge.behind.size()) < kLeastBehind * edge.pixels)
      return std::nullopt;
    if (upper_median_in_place(std::span(edge.noise)) < kWrappedNoise * median_noise_)
      return std::nullopt;
    return plane_behind(edge.behind);
  }
  /// Returns the median noise of all known pixels.
  float find_median_noise() const {
    std::vector<float> all;
    for (int y = 0; y < size_.height; ++y)
      for (int x = 0; x < size_.width; ++x)
        if (z(x, y) > 0) all.push_back(noise(x, y));
    return upper_median_in_place(std::span(all));
  }
  /// Past a pixel towards its neighbour, where that is of another area: at what is farthest.
  void look(int x, int y, int dx, int dy, int root, AreaEdge& edge) {
    const float own = z(x, y);
    float farthest = own;
    int at_u = x, at_v = y;
    for (int i = 1; i <= strip_px_; ++i) {
      const int u = x + i * dx, v = y + i * dy;
      const bool outside = u < 0 || v < 0 || u >= size_.width || v >= size_.height;
      if (i == 1 && !outside && root_of(at(u, v)) == root) return;
      edge.leaves_view |= i == 1 && outside;
      if (outside) break;
      if (z(u, v) > farthest) farthest = z(u, v), at_u = u, at_v = v;
    }
    ++edge.pixels;
    if (farthest > (1 + kBehindPart) * own)
      edge.behind.push_back({1.0 * at_u, 1.0 * at_v, 1.0 / farthest});
  }
  void fill(int root, const Eigen::Vector3d& plane, Image<float>& out) {
    for (int y = 0; y < size_.height; ++y)
      for (int x = 0; x < size_.width; ++x)
        if (root_of(at(x, y)) == root) {
          const double w = Eigen::Vector3d(1, x, y).dot(plane);
          out.row(y)[x] = w > 0 ? static_cast<float>(1 / w) : 0.0F;
        }
  }

  const ImageView<const float> depth_m_, sigma_m_;
  const Size size_;
  const int strip_px_;
  std::vector<int> parent_;
  float median_noise_ = 0;
};

}  // namespace

Image<float> without_wrapped(ImageView<const float> depth_m, ImageView<const float> sigma_m) {
  if (!sigma_m.empty()) return Areas(depth_m, sigma_m).depth_without();
  Image<float> out(depth_m.size);
  for (int y = 0; y < out.height(); ++y) std::copy_n(depth_m.row(y), out.width(), out.row(y));
  return out;
}

}  // namespace mixrig::render

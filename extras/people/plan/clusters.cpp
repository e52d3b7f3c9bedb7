// SPDX-License-Identifier: Apache-2.0
// Groups the pixels that the key assigned to people into clusters in space.
#include "extras/people/plan/clusters.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace mixrig::plan {
namespace {

constexpr int kMostColumns = 320;  ///< of the picture are looked at
constexpr float kFloor_m = 0.03F;  ///< what is lower may be the floor
constexpr float kHighest_m = 2.5F;
constexpr float kHeightStep_m = 0.02F;
constexpr float kLeastCell_m2 = 0.012F;    ///< of a cell and those around it
constexpr float kTop_m2 = 0.004F;          ///< surface above a body's top: single points
constexpr double kExpectedWithin_m = 0.3;  ///< from the seen surface to the axis of a body
constexpr double kApart_m = 0.45;          ///< of the axes of people who are told apart at once
constexpr double kLargeFor_m2 = 0.5;       ///< a larger component may hold several bodies
constexpr float kHead_m = 0.9F, kUnderHead_m2 = 0.12F;
constexpr double kHeadWithin_m = 0.25, kGap_m = 0.25;
constexpr float kNearer_m = 0.15F;  ///< a surface that is so much nearer is another one

}  // namespace

std::span<const Cluster> ClusterFinder::find(const SegmentedView& seen,
                                             std::span<const Expected> expected) {
  clusters_.clear();
  used_ = 0;
  collect(seen);
  if (samples_.empty()) return {};
  count();
  connect();
  divide(expected);
  drop_parts();
  group();
  return clusters_;
}

void ClusterFinder::collect(const SegmentedView& seen) {
  samples_.clear();
  const auto [width, height] = seen.depth_m.size;
  const int step = std::max(1, (width + kMostColumns - 1) / kMostColumns);
  const Eigen::Matrix3f rotation = seen.world_from_view.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f eye = seen.world_from_view.translation_m.cast<float>();
  const auto fx = static_cast<float>(seen.view.fx_px), fy = static_cast<float>(seen.view.fy_px);
  const auto farthest_m = static_cast<float>(options_.farthest_m);
  const float area_at_1_m = static_cast<float>(step * step) / (fx * fy);
  for (int y = step / 2; y < height; y += step) {
    const float* const z = seen.depth_m.row(y);
    const float ray_y = (static_cast<float>(y) - static_cast<float>(seen.view.cy_px)) / fy;
    for (int x = step / 2; x < width; x += step) {
      if (!(z[x] > 0 && z[x] < farthest_m)) continue;
      const float ray_x = (static_cast<float>(x) - static_cast<float>(seen.view.cx_px)) / fx;
      const Eigen::Vector3f at = eye + rotation * (z[x] * Eigen::Vector3f(ray_x, ray_y, 1));
      if (at.z() < kFloor_m || at.z() > kHighest_m) continue;
      const bool at_left = x < 2 * step, at_right = x + 2 * step >= width;
      const bool at_border = at_left || at_right || y < 2 * step || y + 2 * step >= height;
      const auto hides = [&](int beside) { return z[beside] > 0 && z[beside] < z[x] - kNearer_m; };
      const int sides = (at_left || hides(x - step) ? SurfacePoint::kLeft : 0) |
                        (at_right || hides(x + step) ? SurfacePoint::kRight : 0);
      samples_.push_back(
          {{at, area_at_1_m * z[x] * z[x], static_cast<std::uint8_t>(sides)}, at_border, kNone});
    }
  }
}

/// Surface of each cell of the plan around all points, and with the cells around it.
void ClusterFinder::count() {
  Eigen::AlignedBox2f box;
  for (const Sample& s : samples_) box.extend(s.point.at_m.head<2>());
  const auto cell_m = static_cast<float>(options_.cell_m);
  corner_m_ = (box.min().array() - 2 * cell_m).cast<double>();  // two empty cells around
  columns_ = static_cast<int>(box.sizes().x() / cell_m) + 5;
  rows_ = static_cast<int>(box.sizes().y() / cell_m) + 5;
  const auto cells = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  area_m2_.assign(cells, 0), around_m2_.assign(cells, 0), component_of_.assign(cells, kNone);
  top_m_.assign(cells, 0);
  const Eigen::Vector2f corner = corner_m_.cast<float>();
  for (Sample& s : samples_) {
    const Eigen::Vector2f at = (s.point.at_m.head<2>() - corner) / cell_m;
    s.cell = static_cast<int>(at.y()) * columns_ + static_cast<int>(at.x());
    const auto c = static_cast<std::size_t>(s.cell);
    area_m2_[c] += s.point.area_m2;
    top_m_[c] = std::max(top_m_[c], s.point.at_m.z());
  }
  for (int y = 1; y + 1 < rows_; ++y)
    for (int x = 1; x + 1 < columns_; ++x) {
      float sum = 0;
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i)
          sum += area_m2_[static_cast<std::size_t>((y + j) * columns_ + x + i)];
      around_m2_[static_cast<std::size_t>(y * columns_ + x)] = sum;
    }
}

ClusterFinder::Component& ClusterFinder::next_component() {
  if (used_ == components_.size()) components_.emplace_back();
  Component& component = components_[used_++];
  component.cells.clear();
  component.area_m2 = 0, component.is_expected = false;
  return component;
}

void ClusterFinder::connect() {
  for (int cell = 0; cell < columns_ * rows_; ++cell) {
    const auto c = static_cast<std::size_t>(cell);
    if (area_m2_[c] > 0 && around_m2_[c] >= kLeastCell_m2 && component_of_[c] == kNone)
      fill(cell, next_component());
  }
}

void ClusterFinder::fill(int first_cell, Component& component) {
  const int reach = 1 + static_cast<int>(std::lround(options_.join_m / options_.cell_m));
  const int number = static_cast<int>(used_) - 1;
  open_.assign(1, first_cell);
  component_of_[static_cast<std::size_t>(first_cell)] = number;
  while (!open_.empty()) {
    const int cell = open_.back();
    open_.pop_back();
    component.cells.push_back(cell);
    component.area_m2 += area_m2_[static_cast<std::size_t>(cell)];
    const int x = cell % columns_, y = cell / columns_;
    for (int j = std::max(0, y - reach); j <= std::min(rows_ - 1, y + reach); ++j)
      for (int i = std::max(0, x - reach); i <= std::min(columns_ - 1, x + reach); ++i) {
        const auto c = static_cast<std::size_t>(j * columns_ + i);
        if (!(area_m2_[c] > 0 && around_m2_[c] >= kLeastCell_m2) || component_of_[c] != kNone)
          continue;
        component_of_[c] = number;
        open_.push_back(static_cast<int>(c));
      }
  }
}

Eigen::Vector2d ClusterFinder::middle_m(int cell) const {
  return corner_m_ +
         options_.cell_m * Eigen::Vector2d(cell % columns_ + 0.5, cell / columns_ + 0.5);
}

double ClusterFinder::distance_m(const Component& component, const Eigen::Vector2d& place_m) const {
  double least = std::numeric_limits<double>::infinity();
  for (const int cell : component.cells)
    least = std::min(least, (middle_m(cell) - place_m).squaredNorm());
  return std::sqrt(least);
}

double ClusterFinder::distance_m(const Component& a, const Component& b) const {
  double least = std::numeric_limits<double>::infinity();
  for (const int cell : a.cells) least = std::min(least, distance_m(b, middle_m(cell)));
  return least;
}

/// Divides clusters at people seen in the frame before, at hidden ones, then at new heads.
void ClusterFinder::divide(std::span<const Expected> expected) {
  const auto is_new = [&](const Eigen::Vector2d& place) {
    return std::none_of(inside_m_.begin(), inside_m_.end(), [&](const Eigen::Vector2d& known) {
      return (known - place).norm() < kApart_m;
    });
  };
  for (std::size_t c = 0, before = used_; c < before; ++c) {
    inside_m_.clear();
    Component& component = components_[c];
    for (const bool was_seen : {true, false})
      for (const Expected& e : expected) {
        if (e.was_seen != was_seen || distance_m(component, e.at_m) >= kExpectedWithin_m) continue;
        component.is_expected = true;
        if (was_seen || is_new(e.at_m)) inside_m_.push_back(e.at_m);
      }
    if (component.area_m2 > kLargeFor_m2) add_heads(component);
    if (inside_m_.size() > 1) divide(c, inside_m_);
  }
}

/// Peaks of the plan with enough of a body below them, and a gap between them and other people.
void ClusterFinder::add_heads(const Component& component) {
  for (const int cell : component.cells) {
    const float top_m = top_m_[static_cast<std::size_t>(cell)];
    if (top_m < kHead_m) continue;
    const Eigen::Vector2d at = middle_m(cell);
    float around_m2 = 0;
    bool is_peak = true;
    for (const int other : component.cells) {
      if ((middle_m(other) - at).norm() > kHeadWithin_m) continue;
      const auto o = static_cast<std::size_t>(other);
      around_m2 += area_m2_[o];
      is_peak &= top_m_[o] < top_m || (top_m_[o] == top_m && other >= cell);
    }
    if (!is_peak || around_m2 < kUnderHead_m2) continue;
    const bool is_other =
        std::all_of(inside_m_.begin(), inside_m_.end(),
                    [&](const Eigen::Vector2d& known) { return are_two(component, known, at); });
    if (is_other) inside_m_.push_back(at);
  }
}

double ClusterFinder::top_near_m(const Component& component, const Eigen::Vector2d& place_m) const {
  double top_m = 0;
  for (const int cell : component.cells)
    if ((middle_m(cell) - place_m).norm() < kHeadWithin_m)
      top_m = std::max<double>(top_m, top_m_[static_cast<std::size_t>(cell)]);
  return top_m;
}

/// Whether the surface falls by the height of a head between two places.
bool ClusterFinder::are_two(const Component& component, const Eigen::Vector2d& a,
                            const Eigen::Vector2d& b) const {
  if ((a - b).norm() < kApart_m) return false;
  const double lower_m = std::min(top_near_m(component, a), top_near_m(component, b));
  const int steps = std::max(2, static_cast<int>((a - b).norm() / options_.cell_m));
  double saddle_m = lower_m;
  for (int i = 0; i <= steps; ++i) {
    const Eigen::Vector2d at = (a + (b - a) * i / steps - corner_m_) / options_.cell_m;
    const int x = std::clamp(static_cast<int>(at.x()), 0, columns_ - 1);
    const int y = std::clamp(static_cast<int>(at.y()), 0, rows_ - 1);
    saddle_m = std::min<double>(saddle_m, top_m_[static_cast<std::size_t>(y * columns_ + x)]);
  }
  return saddle_m < lower_m - kGap_m;
}

void ClusterFinder::divide(std::size_t component, std::span<const Eigen::Vector2d> inside_m) {
  const std::vector<int> cells = components_[component].cells;
  const std::size_t first = used_;
  for (std::size_t k = 1; k < inside_m.size(); ++k) next_component();
  components_[component].cells.clear();
  components_[component].area_m2 = 0;
  for (const int cell : cells) {
    const Eigen::Vector2d at = middle_m(cell);
    const auto nearest = std::min_element(inside_m.begin(), inside_m.end(),
                                          [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
                                            return (a - at).squaredNorm() < (b - at).squaredNorm();
                                          }) -
                         inside_m.begin();
    Component& part =
        components_[nearest == 0 ? component : first + static_cast<std::size_t>(nearest) - 1];
    part.cells.push_back(cell);
    part.area_m2 += area_m2_[static_cast<std::size_t>(cell)];
    part.is_expected = true;
  }
}

/// Components that are too small join one that is near, or are none.
void ClusterFinder::drop_parts() {
  const auto stands_alone = [&](const Component& c) {
    return c.area_m2 >= (c.is_expected ? options_.least_known_m2 : options_.least_m2);
  };
  for (std::size_t c = 0; c < used_; ++c) {
    Component& part = components_[c];
    if (stands_alone(part) || part.cells.empty()) continue;
    double least_m = options_.part_within_m;
    Component* whole = nullptr;
    for (std::size_t other = 0; other < used_; ++other) {
      if (other == c || !stands_alone(components_[other])) continue;
      const double d = distance_m(part, components_[other]);
      if (d < least_m) least_m = d, whole = &components_[other];
    }
    if (whole != nullptr) {
      whole->cells.insert(whole->cells.end(), part.cells.begin(), part.cells.end());
      whole->area_m2 += part.area_m2;
    }
    part.cells.clear();
    part.area_m2 = 0;
  }
}

/// Makes clusters of the components: their points, and what find() reports of each.
void ClusterFinder::group() {
  order_.clear();
  for (std::size_t c = 0; c < used_; ++c)
    if (!components_[c].cells.empty()) order_.push_back(static_cast<int>(c));
  std::sort(order_.begin(), order_.end(), [&](int a, int b) {
    return components_[static_cast<std::size_t>(a)].area_m2 >
           components_[static_cast<std::size_t>(b)].area_m2;
  });
  std::fill(component_of_.begin(), component_of_.end(), kNone);
  for (std::size_t k = 0; k < order_.size(); ++k)
    for (const int cell : components_[static_cast<std::size_t>(order_[k])].cells)
      component_of_[static_cast<std::size_t>(cell)] = static_cast<int>(k);
  clusters_.assign(order_.size(), {});
  heights_m2_.assign(order_.size(), {});
  begin_.assign(order_.size() + 1, 0);
  for (const Sample& s : samples_)
    if (const int k = component_of_[static_cast<std::size_t>(s.cell)]; k != kNone)
      ++begin_[static_cast<std::size_t>(k) + 1];
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  points_.resize(static_cast<std::size_t>(begin_.back()));
  for (std::size_t k = 0; k < clusters_.size(); ++k)
    clusters_[k].points = {points_.data() + begin_[k], points_.data() + begin_[k + 1]};
  for (const Sample& s : samples_) {
    const int number = component_of_[static_cast<std::size_t>(s.cell)];
    if (number == kNone) continue;
    const auto k = static_cast<std::size_t>(number);
    points_[static_cast<std::size_t>(begin_[k]++)] = s.point;
    Cluster& cluster = clusters_[k];
    cluster.center_m += double{s.point.area_m2} * s.point.at_m.cast<double>();
    cluster.area_m2 += s.point.area_m2;
    cluster.is_cut |= s.at_border;
    const int step = std::min(kHeights - 1, static_cast<int>(s.point.at_m.z() / kHeightStep_m));
    heights_m2_[k][static_cast<std::size_t>(step)] += s.point.area_m2;
  }
  for (std::size_t k = 0; k < clusters_.size(); ++k) {
    Cluster& cluster = clusters_[k];
    cluster.center_m /= cluster.area_m2;
    float above_m2 = 0;
    int step = kHeights - 1;
    while (step > 0 && (above_m2 += heights_m2_[k][static_cast<std::size_t>(step)]) < kTop_m2)
      --step;
    cluster.top_m = double{kHeightStep_m} * (step + 1);
  }
}

}  // namespace mixrig::plan

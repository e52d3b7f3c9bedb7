// SPDX-License-Identifier: Apache-2.0
#include "host/room/background/seen_through.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/room/background/room_surface.h"

namespace mixrig::model {
namespace {

constexpr int kCellsAcross = 80, kLeastCell_px = 4;
constexpr int kRayStep = 2;  ///< every second depth pixel of a row and column
constexpr double kWindow_s = 1;
constexpr int kMostFrames = 30, kLeastFrames = 3;
constexpr float kNothing = std::numeric_limits<float>::max();

}  // namespace

SeenThrough::SeenThrough(const render::CompositorSetup& setup)
    : view_(setup.view),
      target_from_tof_(setup.target_from_tof),
      is_distance_(setup.depth_is_distance),
      cell_px_(std::max(kLeastCell_px, setup.view.size_px.width / kCellsAcross)),
      columns_(setup.view.size_px.width / cell_px_),
      cells_(static_cast<std::size_t>(columns_ * (setup.view.size_px.height / cell_px_))),
      tof_px_(setup.tof.size_px()) {
  find_surfaces(setup.background);
  set_rays(setup.tof);
}

/// A cell counts where most of its pixels are known and lie on one surface.
void SeenThrough::find_surfaces(const render::BackgroundView& background) {
  constexpr double kLeastKnown = 0.6;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const int left = static_cast<int>(i) % columns_ * cell_px_;
    const int top = static_cast<int>(i) / columns_ * cell_px_;
    float near_m = kNothing, far_m = 0;
    int known = 0;
    for (int y = top; y < top + cell_px_; ++y)
      for (int x = left; x < left + cell_px_; ++x)
        if (const float z_m = background.depth_m.row(y)[x]; z_m > 0) {
          near_m = std::min(near_m, z_m), far_m = std::max(far_m, z_m);
          ++known;
        }
    const float reach_m = surface_reach_m(far_m);
    if (known >= kLeastKnown * cell_px_ * cell_px_ && far_m - near_m <= reach_m)
      cells_[i].far_m = far_m, cells_[i].reach_m = reach_m;
  }
}

void SeenThrough::set_rays(const geometry::CameraModel& tof) {
  for (int y = 0; y < tof_px_.height; y += kRayStep)
    for (int x = 0; x < tof_px_.width; x += kRayStep) {
      Eigen::Vector3d ray = Eigen::Vector3d::Zero();
      if (const auto at = tof.unproject({x, y})) {
        ray = {at->x(), at->y(), 1};
        if (is_distance_) ray.normalize();
        ray = target_from_tof_.rotation * ray;
      }
      rays_.push_back(ray.cast<float>());
    }
}

void SeenThrough::add_depth(const Image<float>& depth_m) {
  const Eigen::Vector3f from = target_from_tof_.translation_m.cast<float>();
  std::size_t ray = 0;
  for (int y = 0; y < tof_px_.height; y += kRayStep)
    for (int x = 0; x < tof_px_.width; x += kRayStep, ++ray) {
      const float value_m = depth_m.row(y)[x];
      if (!(value_m > 0) || !std::isfinite(value_m)) continue;
      const Eigen::Vector3f at = from + value_m * rays_[ray];
      if (!(at.z() > 0)) continue;
      const Eigen::Vector2d px = view_.project(at.cast<double>());
      const double column = std::floor(px.x() / cell_px_), row = std::floor(px.y() / cell_px_);
      if (!(column >= 0 && column < columns_ && row >= 0)) continue;
      const auto cell = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                        static_cast<std::size_t>(column);
      if (cell < cells_.size()) cells_[cell].nearest_m = std::min(cells_[cell].nearest_m, at.z());
    }
}

double SeenThrough::share() const {
  constexpr double kMostFramesShare = 0.8;
  int known = 0, through = 0;
  for (const Cell& cell : cells_) {
    if (cell.far_m <= 0 || 2 * cell.measured < frames_) continue;
    ++known;
    through += cell.through >= kMostFramesShare * cell.measured;
  }
  return known > 0 ? static_cast<double>(through) / known : 0;
}

std::optional<double> SeenThrough::add(const capture::Capture& capture) {
  if (done_ || capture.depth_m.size() != tof_px_) return std::nullopt;
  if (frames_ == 0) first_s_ = capture.time_s;
  for (Cell& cell : cells_) cell.nearest_m = kNothing;
  add_depth(capture.depth_m);
  for (Cell& cell : cells_) {
    if (cell.far_m <= 0 || cell.nearest_m == kNothing) continue;
    ++cell.measured;
    cell.through += cell.nearest_m > cell.far_m + cell.reach_m;
  }
  ++frames_;
  done_ =
      frames_ >= kLeastFrames && (frames_ >= kMostFrames || capture.time_s - first_s_ >= kWindow_s);
  return done_ ? std::optional(share()) : std::nullopt;
}

}  // namespace mixrig::model

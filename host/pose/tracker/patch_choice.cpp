// SPDX-License-Identifier: Apache-2.0
#include "host/pose/tracker/patch_choice.h"

#include <algorithm>
#include <cmath>

#include "host/pose/tracker/grey_pyramid.h"

namespace mixrig::tracking {
namespace {

constexpr double kLeastScale = 0.7071, kMostScale = 1.4142;
constexpr float kLeastFacing = 0.2F;  ///< cosine of incidence

/// Returns the pixels per radian in the middle of the picture.
double pixels_per_rad(const geometry::AnyCamera& camera) {
  return geometry::parameters_of(camera)[0];
}

}  // namespace

PatchChoice::PatchChoice(const PatchMap& map, const geometry::AnyCamera& camera, int patches)
    : map_(map), camera_(camera), most_(static_cast<std::size_t>(patches)) {
  const Size size = geometry::size_px(camera);
  // If half of the cells are empty, two patches per other cell reach the number.
  const double side = std::sqrt(static_cast<double>(size.area()) / patches);
  cells_ = {std::max(1, static_cast<int>(size.width / side)),
            std::max(1, static_cast<int>(size.height / side))};
  best_.resize(static_cast<std::size_t>(cells_[0] * cells_[1]));
  chosen_.reserve(kPerCell * best_.size());
}

const std::vector<const Patch*>& PatchChoice::choose(const geometry::Pose& camera_from_room,
                                                     int k) {
  for (auto& cell : best_) cell.fill({nullptr, 0});
  const Size size = geometry::size_px(camera_);
  const Eigen::Matrix3f turn = camera_from_room.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f shift = camera_from_room.translation_m.cast<float>();
  const Eigen::Vector3f eye = -(turn.transpose() * shift);
  const double picture_rad = (1 << k) / pixels_per_rad(camera_);
  for (const std::vector<Patch>& level : map_.levels)
    for (const Patch& p : level) {
      const Eigen::Vector3f to_eye = eye - p.centre_m;
      const float distance_m = to_eye.norm();
      const double scale = p.pixel_rad * p.range_m / (distance_m * picture_rad);
      if (!(scale >= kLeastScale && scale < kMostScale)) continue;
      if (p.normal.dot(to_eye) < kLeastFacing * distance_m) continue;
      const auto px =
          geometry::project(camera_, Eigen::Vector3d((turn * p.centre_m + shift).cast<double>()));
      if (!px) continue;
      const double margin = kPatchSide << k;
      if (px->x() < margin || px->y() < margin || px->x() > size.width - margin ||
          px->y() > size.height - margin)
        continue;
      auto& cell = best_[static_cast<std::size_t>(
          static_cast<int>(px->y() * cells_[1] / size.height) * cells_[0] +
          static_cast<int>(px->x() * cells_[0] / size.width))];
      Best best{&p, p.score};
      for (Best& kept : cell)
        if (best.score > kept.score) std::swap(best, kept);
    }
  chosen_.clear();
  for (std::size_t rank = 0; rank < kPerCell; ++rank)
    for (const auto& cell : best_)
      if (cell[rank].patch != nullptr && chosen_.size() < most_ &&
          !map_.hidden(eye, cell[rank].patch->centre_m))
        chosen_.push_back(cell[rank].patch);
  return chosen_;
}

}  // namespace mixrig::tracking

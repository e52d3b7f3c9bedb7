// SPDX-License-Identifier: Apache-2.0
// The region of a depth picture that one plane explains, grown from a click.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "host/room/click/click_grid.h"

namespace mixrig::model {

/// Share of a depth's sigma that all depths of a region have in common.
constexpr double kCommonShare = 0.1;

/// A plane a . p = 1 in the depth camera's axes; its inverse depth on a ray is a . ray.
struct InversePlane {
  Eigen::Vector3d a = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();

  /// Signed distance of a sample behind the plane, along the depth camera's axis.
  double off_m(const ClickSample& s, const geometry::Pose& tof_from_view) const;
};

/// Borrows `grid`, which must outlive this object.
class ClickRegion {
 public:
  explicit ClickRegion(const ClickGrid& grid)
      : grid_(grid), tof_from_view_(geometry::inverse(grid.view_from_tof())), part_(grid.size()) {}

  bool fits(const InversePlane& plane, ClickPlace at) const;
  /// Signed distance behind the plane, in sigmas of the depth.
  double sigmas(const InversePlane& plane, ClickPlace at) const;
  /// Grows the region from the seeds over all neighbours that fit the plane.
  void grow(const InversePlane& plane, const std::vector<ClickPlace>& seeds);
  /// Keeps only what is connected with the seeds over squares whose mean lies on the plane: a thing
  /// on a wall may be within the noise of a pixel, but not of a mean.
  void keep_flat(const InversePlane& plane, const std::vector<ClickPlace>& seeds);
  /// Fits inverse depth by least squares; nullopt if the places do not determine a plane.
  std::optional<InversePlane> fit(const std::vector<ClickPlace>& places) const;
  /// Places at least two pixels inside the region: at its border a pixel sees two surfaces.
  std::vector<ClickPlace> inner_places() const;
  const std::vector<ClickPlace>& places() const { return places_; }
  Image<std::uint8_t> part() && { return std::move(part_); }

 private:
  void take(const InversePlane& plane, ClickPlace at);

  const ClickGrid& grid_;
  geometry::Pose tof_from_view_;
  Image<std::uint8_t> part_;
  std::vector<ClickPlace> places_;
};

}  // namespace mixrig::model

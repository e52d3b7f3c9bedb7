// SPDX-License-Identifier: Apache-2.0
// The part of a depth picture that one plane explains, grown from a click.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "host/room/click/click_grid.h"

namespace mixrig::model {

/// Share of a depth's sigma that is common to a region.
constexpr double kCommonShare = 0.1;

/// Inverse depth a . ray of a plane a . p = 1 in the depth camera's axes.
struct InversePlane {
  Eigen::Vector3d a = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();

  /// How much farther a sample lies than the plane, along the depth camera's axis.
  double off_m(const ClickSample& s, const geometry::Pose& tof_from_view) const;
};

/// Keeps `grid`, which must live as long.
class ClickRegion {
 public:
  explicit ClickRegion(const ClickGrid& grid)
      : grid_(grid), tof_from_view_(geometry::inverse(grid.view_from_tof())), part_(grid.size()) {}

  bool fits(const InversePlane& plane, ClickPlace at) const;
  /// How much farther than the plane, in sigmas of the depth.
  double sigmas(const InversePlane& plane, ClickPlace at) const;
  /// From the seeds over all neighbours that fit.
  void grow(const InversePlane& plane, const std::vector<ClickPlace>& seeds);
  /// Keeps what goes on from the seeds over squares that lie on the plane as a whole: things on a
  /// wall may be within the noise of each pixel, but not within that of their mean.
  void keep_flat(const InversePlane& plane, const std::vector<ClickPlace>& seeds);
  /// Least squares of inverse depth; nullopt where the places do not determine a plane.
  std::optional<InversePlane> fit(const std::vector<ClickPlace>& places) const;
  /// Those that lie two pixels within the region: at its border a pixel sees two surfaces.
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

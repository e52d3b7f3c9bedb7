// SPDX-License-Identifier: Apache-2.0
// A depth picture as points in axes of the clicked view.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "host/room/click/clicked_plane.h"

namespace mixrig::model {

/// A pixel of the depth camera.
struct ClickSample {
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();  ///< axes of the view; zero: unknown
  Eigen::Vector3d ray = Eigen::Vector3d::Zero();      ///< axes of the depth camera, with z = 1
  double sigma_m = 0;                                 ///< of z
  bool known() const { return sigma_m > 0; }
};

/// A pixel of the depth picture.
struct ClickPlace {
  int x = 0, y = 0;
};

/// Borrows `picture`, which must outlive this object.
class ClickGrid {
 public:
  explicit ClickGrid(const ClickPicture& picture);
  Size size() const { return picture_.depth_m.size; }
  const ClickSample& at(int x, int y) const { return samples_[index(x, y)]; }
  const ClickSample& at(ClickPlace place) const { return at(place.x, place.y); }
  const geometry::Pose& view_from_tof() const { return picture_.view_from_tof; }
  void scale_sigmas(double factor);

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(size().width) +
           static_cast<std::size_t>(x);
  }
  ClickSample sample(int x, int y) const;

  const ClickPicture& picture_;
  std::vector<ClickSample> samples_;
};

}  // namespace mixrig::model

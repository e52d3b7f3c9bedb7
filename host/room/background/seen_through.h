// SPDX-License-Identifier: Apache-2.0
// Whether the background of a still camera holds people or things that are gone.
#pragma once

#include <optional>
#include <vector>

#include "host/capture/capture/capture.h"
#include "host/render/contract/compositor.h"

namespace mixrig::model {

/// Looks in the first second of a run for cells of the view in which all depth lies behind the
/// background's surface: nobody sees through a wall, so that surface was somebody or something that
/// has left. Borders of depth are left out. add() allocates nothing. Not thread-safe.
class SeenThrough {
 public:
  /// Precondition: the setup has a background of one view, and a lens that does not move.
  explicit SeenThrough(const render::CompositorSetup& setup);
  /// Adds a frame. Returns once, after a second, the share of the cells; then and before nullopt.
  std::optional<double> add(const capture::Capture& capture);

 private:
  struct Cell {
    float far_m = 0, reach_m = 0;  ///< of the background; 0: not one surface
    float nearest_m = 0;           ///< in this frame
    int measured = 0, through = 0;
  };
  void find_surfaces(const render::BackgroundView& background);
  void set_rays(const geometry::CameraModel& tof);
  void add_depth(const Image<float>& depth_m);
  double share() const;

  geometry::Pinhole view_;
  geometry::Pose target_from_tof_;
  bool is_distance_;
  int cell_px_, columns_;
  std::vector<Cell> cells_;
  Size tof_px_;
  std::vector<Eigen::Vector3f> rays_;  ///< in the target's axes for depth 1; zero: none
  int frames_ = 0;
  double first_s_ = 0;
  bool done_ = false;
};

}  // namespace mixrig::model

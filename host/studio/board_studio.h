// SPDX-License-Identifier: Apache-2.0
// Views of a calibration board by every camera of a rig, with the truth behind them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "host/studio/board_pattern.h"
#include "host/studio/board_rig.h"

namespace mixrig::studio {

struct BoardOptions {
  RigPreset rig = RigPreset::kKinect2;
  unsigned seed = 1;
  int views = 20;            ///< 1..500
  Size size_px{1280, 1024};  ///< target camera, 64..4096 a side
  int threads = 0;           ///< 0: one per core
  BoardPlan board;
  bool pan_tilt = false;         ///< the board stands still and the unit turns
  double blur_px = 0.6;          ///< sigma of every lens, 0..10
  double noise = 1;              ///< of every sensor, against its own, 0..100
  double depth_error_m = 0.015;  ///< largest systematic depth error, 0..0.1
  double amplitude_error_m = 0;  ///< of depth where the light is a tenth of the brightest, +-0.1
  double pixel_error_m = 0;      ///< of depth in the corners of the picture, +-0.1
};

/// What holds for all views.
struct BoardInfo {
  std::string name;  ///< "board 3, kinect2"
  BoardOptions options;
  BoardRig rig;
};

/// What the sensors deliver with the board held still.
struct BoardView {
  int number = 0;  ///< 1-based
  Image<Rgb8> target, fisheye;
  Image<float> tof_distance_m;       ///< along the ray, whole depth units; 0 = unknown
  Image<float> tof_amplitude;        ///< counts, 65535 = a full tap
  double pan_rad = 0, tilt_rad = 0;  ///< as the encoders tell, whole steps
  geometry::Pose target_from_board;  ///< truth
};

/// Renders views in any order; a view's bytes depend on the options alone. Every fifth view is for
/// the fisheye camera alone: the board is far off the axis. Not thread-safe.
class BoardStudio {
 public:
  /// Errors: kUsage for options out of range, kUnsupported where Embree does not start.
  static Result<BoardStudio> create(const BoardOptions& options);
  BoardStudio(BoardStudio&&) noexcept;
  BoardStudio& operator=(BoardStudio&&) noexcept;
  ~BoardStudio();

  const BoardInfo& info() const;
  /// Renders view `number` (1..views).
  void render(int number, BoardView& view);

 private:
  struct State;
  explicit BoardStudio(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace mixrig::studio

// SPDX-License-Identifier: Apache-2.0
// Views of a calibration board by every camera of a rig, with ground truth.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "studio/board/board_pattern.h"
#include "studio/rig_of_seed.h"

namespace mixrig::studio {

/// How a person holds the board: still for `rest_s` at the pose of each view, then on to the next.
struct HandMotion {
  double rest_s = 0.8, move_s = 0.8;  ///< 0.1..10 each
  /// Standard deviation of the board's middle along each axis, 0..0.01; the board turns too.
  double tremor_m = 0;
};

struct BoardOptions {
  RigPreset rig = RigPreset::kKinect2;
  std::optional<RigPreset> second_tof;  ///< as StudioOptions::second_tof
  unsigned seed = 1;
  int views = 20;            ///< 1..500
  Size size_px{1280, 1024};  ///< target camera, 64..4096 a side
  int threads = 0;           ///< 0: one per core
  BoardPlan board;
  bool pan_tilt = false;     ///< the board is fixed and the unit turns
  double far_m = 2.4;        ///< most distance of the boards before the cameras, 0.5..10
  double blur_px = 0.6;      ///< sigma of every lens, 0..10
  double noise = 1;          ///< factor on the noise of every sensor, 0..100
  double tolerance = 0;      ///< of lenses and mounting by seed, as StudioOptions::tolerance
  double lens_error_px = 0;  ///< of the target camera, outside its model, at the corners, 0..5
  bool raw_depth = false;    ///< leave the ToF camera's systematic error in
  /// Largest systematic depth error, 0..0.1; without it that of the rig's takes.
  std::optional<double> depth_error_m;
  Size fisheye_px{1280, 1024};  ///< 64..4096 a side; the same field
  HandMotion hand;              ///< of render_moment()
};

/// Properties of all views.
struct BoardInfo {
  std::string name;  ///< "board 3, kinect2"
  BoardOptions options;
  Rig rig;  ///< wiggle_rad of its depth cameras as it is in the views
};

/// The measurements of all sensors while nothing moves.
struct BoardView {
  int number = 0;  ///< 1-based
  Image<Rgb8> target, fisheye;
  Image<float> tof_distance_m;  ///< along the ray, multiple of the depth unit; 0 = unknown
  Image<float> tof_amplitude;   ///< counts, 65535 = full well of a tap
  Image<float> tof2_distance_m, tof2_amplitude;  ///< of BoardOptions::second_tof
  double pan_rad = 0, tilt_rad = 0;              ///< as the encoders report, multiple of the step
  geometry::Pose target_from_board;              ///< truth
};

/// Renders views in any order. The bytes of a view depend on the options only. In every fifth view
/// the board is far off the axis, for the fisheye camera only. Not thread-safe.
class BoardStudio {
 public:
  /// Errors: kUsage for options out of range, kUnsupported if Embree does not start.
  static Result<BoardStudio> create(const BoardOptions& options);
  BoardStudio(BoardStudio&&) noexcept;
  BoardStudio& operator=(BoardStudio&&) noexcept;
  ~BoardStudio();

  const BoardInfo& info() const;
  /// Renders view `number` (1..views).
  void render(int number, BoardView& view);
  /// Renders target and depth camera around a time, with blur where the board moves within the
  /// exposure. The board is in the hands of a person (hand_pose); with BoardOptions::pan_tilt it
  /// stands still before a head that stands and turns as `head` says. `number` (1-based) seeds the
  /// noise. The fisheye's picture stays unchanged.
  void render_moment(int number, double time_s, const HeadMotion& head, BoardView& view);
  /// Renders the fisheye's picture alone, in the manner of render_moment().
  void render_fisheye(int number, double time_s, const HeadMotion& head, Image<Rgb8>& picture);

 private:
  struct State;
  explicit BoardStudio(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace mixrig::studio

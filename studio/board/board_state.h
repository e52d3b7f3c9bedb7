// SPDX-License-Identifier: Apache-2.0
// State of BoardStudio: the board, the room, the cameras and the buffers of a view.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "studio/board/behind_board.h"
#include "studio/board/board_camera.h"
#include "studio/board/board_poses.h"
#include "studio/board/board_studio.h"
#include "studio/sensors/tof.h"
#include "studio/stage/light.h"
#include "studio/stage/materials.h"

namespace mixrig::studio {

constexpr int kBoardBand = 8;  ///< rows of a picture that a thread draws at once

/// A depth camera before the board.
struct BoardTof {
  BoardTof(const TofSensor& sensor_of, const RayFunction& rays, double blur_px,
           std::uint64_t salt_of)
      : sensor(sensor_of),
        camera(sensor_of.optics.size_px, rays, blur_px),
        behind(sensor_of.optics.size_px),
        salt(salt_of) {}
  TofSensor sensor;
  BoardCamera camera;
  BehindBoard<Echo> behind;
  std::uint64_t salt;  ///< of its noise
  std::array<std::vector<Echo>, 4> taps;
};

struct BoardStudio::State {
  using Poses = std::span<const geometry::Pose>;
  static constexpr double kFar_m = 2e-3;  ///< of a board that moves far within an exposure
  State(const BoardOptions& o, const TraceDevice& device);

  /// Linear colour of the room behind the board.
  Vec3 background_color(const Eigen::Vector3f& ray, const geometry::Pose& world_from_camera) const;
  /// `poses` of the board in the slices of the exposure, target_from_board.
  void draw_color(BoardCamera& camera, const geometry::Pose& target_from_camera, Poses poses,
                  int number, int salt, BehindBoard<Vec3>& behind, Image<Rgb8>& picture);
  /// `poses` at the four taps, or one for all.
  void draw_tof(BoardTof& of, Poses poses, int number, Image<float>& distance_m,
                Image<float>& amplitude);
  /// Renders all depth cameras; `poses_at` returns the poses for a sensor.
  template <typename PosesAt>
  void draw_tofs(const PosesAt& poses_at, BoardView& view) {
    draw_tof(tof, poses_at(tof.sensor), view.number, view.tof_distance_m, view.tof_amplitude);
    if (tof2)
      draw_tof(*tof2, poses_at(tof2->sensor), view.number, view.tof2_distance_m,
               view.tof2_amplitude);
  }
  /// The outline of a board that may move tells nothing; one that moves far within an exposure is
  /// blurred by more than its samples show.
  SampleSteps steps_of(Poses poses) const {
    const bool far = moved_m(poses.front(), poses.back()) > kFar_m;
    return {coarse_border ? 9 : 1, far ? 9 : 1};
  }
  /// Most that a corner of the board moves between two poses.
  double moved_m(const geometry::Pose& from, const geometry::Pose& to) const {
    const Eigen::Vector3d corner(info.options.board.width_m(), info.options.board.height_m(), 0);
    return std::max((to.translation_m - from.translation_m).norm(),
                    (to * corner - from * corner).norm());
  }
  std::vector<geometry::Pose> poses_about(double time_s, double exposure_s, int slices) const;
  BoardPlace place_before(const HeadMotion& head) const;
  Echo board_echo(BoardTof& of, const BoardPixel& p, std::size_t index, int x, int y,
                  const geometry::Pose& world_from_tof);
  void turn_to(const BoardPlace& place);
  Echo background_echo(const TofSensor& sensor, const Eigen::Vector3f& ray,
                       const geometry::Pose& world_from_tof) const;

  BoardInfo info;
  Light light;
  LampSet lamps;
  Materials materials;
  BoardPattern pattern;
  Crew crew;
  TraceScene room, board;
  BoardCamera target, fisheye;
  BoardTof tof;
  std::optional<BoardTof> tof2;
  BehindBoard<Vec3> behind_target, behind_fisheye;
  double pan_rad = 0, tilt_rad = 0;
  bool coarse_border = false;  ///< of moments
  geometry::Pose rest;         ///< world_from_target at pan = tilt = 0
  geometry::Pose world_from_target;
  NormalTable normal;
  std::vector<BoardPixel> pixels;
  std::vector<Vec3> light_sum;
};

}  // namespace mixrig::studio

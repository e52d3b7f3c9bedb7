// SPDX-License-Identifier: Apache-2.0
// The pose of the board in every view.
#include "studio/board/board_poses.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hal/base/angles.h"
#include "studio/sensors/lens.h"
#include "studio/sensors/noise.h"

namespace mixrig::studio {
namespace {

constexpr int kOffAxisEvery = 5;

/// Random values for one attempt at one view.
class RandomDraw {
 public:
  RandomDraw(unsigned seed, int view, int attempt)
      : key_(hash_key(
            seed, 0xB0A9D,
            static_cast<std::uint64_t>(view) * 4096 + static_cast<std::uint64_t>(attempt))) {}
  double between(double low, double high) {
    return low + (high - low) * uniform(hash_key(key_, ++count_));
  }

 private:
  std::uint64_t key_, count_ = 0;
};

/// Pose of a board with its centre at `centre` (target axes), rotated by `roll` in its plane and
/// tilted by `tilt` about an axis in its plane.
geometry::Pose board_pose(const BoardPlan& plan, const Eigen::Vector3d& centre, double roll_rad,
                          double tilt_rad, double about_rad) {
  // Facing the camera: the w axis is parallel to the line of sight.
  // From the optical axis to the middle, the short way.
  const Eigen::Vector3d d = centre.normalized();
  const Eigen::Quaterniond facing = Eigen::Quaterniond(1 + d.z(), -d.y(), d.x(), 0).normalized();
  const Eigen::Vector3d axis(std::cos(about_rad), std::sin(about_rad), 0);
  const Eigen::Quaterniond turn = facing * Eigen::AngleAxisd(tilt_rad, axis) *
                                  Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitZ());
  const Eigen::Vector3d middle(0.5 * plan.width_m(), 0.5 * plan.height_m(), 0);
  return {turn, centre - turn * middle};
}

bool inside(const Optics& optics, const Eigen::Vector3d& p) {
  if (p.z() < 0.1) return false;
  const Eigen::Vector2d px = project(optics, p);
  const double margin = 0.015 * optics.size_px.width;
  return px.x() > margin && px.y() > margin && px.x() < optics.size_px.width - 1 - margin &&
         px.y() < optics.size_px.height - 1 - margin;
}

/// True if all squares and half of the margin are in the target and the ToF picture.
bool fully_visible(const BoardInfo& info, const geometry::Pose& target_from_board) {
  const BoardPlan& plan = info.options.board;
  const geometry::Pose tof_from_target = geometry::inverse(info.rig.tof.target_from_tof);
  const double m = 0.5 * plan.margin_m();
  for (const double u : {-m, plan.width_m() + m})
    for (const double v : {-m, plan.height_m() + m}) {
      const Eigen::Vector3d p = target_from_board * Eigen::Vector3d(u, v, 0);
      if (!inside(info.rig.target, p) || !inside(info.rig.tof.optics, tof_from_target * p))
        return false;
    }
  return true;
}

/// Distance at which a board that faces the camera fills at most 0.8 of both pictures.
double nearest_distance_m(const BoardInfo& info) {
  double need = 0;
  for (const Optics& o : {info.rig.target, info.rig.tof.optics})
    need = std::max({need, info.options.board.width_m() * o.fx_px / (0.8 * o.size_px.width),
                     info.options.board.height_m() * o.fy_px / (0.8 * o.size_px.height)});
  return need;
}

geometry::Pose off_axis_pose(const BoardInfo& info, RandomDraw& draw) {
  const double angle = draw.between(38, 70) * kDeg;
  const double around = draw.between(0, 2 * std::numbers::pi);
  const double distance = draw.between(0.7, 1.0);
  const Eigen::Vector3d direction(std::sin(angle) * std::cos(around),
                                  0.6 * std::sin(angle) * std::sin(around), std::cos(angle));
  return board_pose(info.options.board, distance * direction.normalized(),
                    draw.between(-15, 15) * kDeg, draw.between(0, 30) * kDeg,
                    draw.between(0, 2 * std::numbers::pi));
}

geometry::Pose in_view_pose(const BoardInfo& info, int number, RandomDraw& draw, int attempt) {
  const double near = nearest_distance_m(info), far = std::max(info.options.far_m, 1.3 * near);
  // Golden-ratio sequence: distances cover the whole range for any number of views, more of them
  // near.
  const double share = std::fmod(number * 0.6180339887498949, 1.0);
  const double z = near + (far - near) * share * std::sqrt(share);
  const double range = attempt > 200 ? 0.5 : 1;  // a board that fills the picture has little room
  const Optics& o = info.rig.target;
  const double x = 0.4 * range * draw.between(-1, 1) * o.size_px.width / o.fx_px;
  const double y = 0.4 * range * draw.between(-1, 1) * o.size_px.height / o.fy_px;
  return board_pose(info.options.board, z * Eigen::Vector3d(x, y, 1), draw.between(-20, 20) * kDeg,
                    draw.between(12, 45) * range * kDeg, draw.between(0, 2 * std::numbers::pi));
}

BoardPlace pan_tilt_place(const BoardInfo& info, int number) {
  const PanTiltUnit& unit = info.rig.pan_tilt;
  const double distance = std::max(1.7, 1.5 * nearest_distance_m(info));
  const geometry::Pose rest_from_board =
      board_pose(info.options.board, {0.03, -0.02, distance}, 4 * kDeg, 24 * kDeg, 60 * kDeg);
  for (int attempt = 0;; ++attempt) {
    RandomDraw draw(info.options.seed, number, attempt);
    const double reach = number == 1 ? 0 : 30 * std::pow(0.995, attempt);
    BoardPlace place;
    place.pan_rad = whole_steps(unit, draw.between(-reach, reach) * kDeg);
    place.tilt_rad = whole_steps(unit, draw.between(-0.7 * reach, 0.7 * reach) * kDeg);
    const double slack =
        std::sqrt(3.0) *
        unit.repeatability_rad;  // half width of a uniform distribution with that sigma
    const double pan = place.pan_rad + draw.between(-slack, slack);
    const double tilt = place.tilt_rad + draw.between(-slack, slack);
    place.target_from_board =
        geometry::inverse(rest_from_turned(unit, pan, tilt)) * rest_from_board;
    if (fully_visible(info, place.target_from_board) || attempt > 1000) return place;
  }
}

}  // namespace

BoardPlace board_place(const BoardInfo& info, int number) {
  if (info.options.pan_tilt) return pan_tilt_place(info, number);
  for (int attempt = 0;; ++attempt) {
    RandomDraw draw(info.options.seed, number, attempt);
    if (number % kOffAxisEvery == 0) return {off_axis_pose(info, draw)};
    const geometry::Pose pose = in_view_pose(info, number, draw, attempt);
    if (fully_visible(info, pose) || attempt > 1000) return {pose};
  }
}

}  // namespace mixrig::studio

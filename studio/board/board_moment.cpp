// SPDX-License-Identifier: Apache-2.0
// A board that moves, or stands before a head that turns, at one time.
#include <algorithm>
#include <cmath>

#include "studio/board/board_hand.h"
#include "studio/board/board_state.h"

namespace mixrig::studio {
namespace {

constexpr double kBoardExposure_s = 0.008;  ///< of the colour cameras
constexpr int kBlurSlices = 4;
constexpr double kSharp_m = 2e-4;  ///< a board that moves less within an exposure is not blurred

}  // namespace

std::vector<geometry::Pose> BoardStudio::State::poses_about(double time_s, double exposure_s,
                                                            int slices) const {
  std::vector<geometry::Pose> poses;
  for (int i = 0; i < slices; ++i) {
    const double at_s = time_s + exposure_s * ((i + 0.5) / slices - 0.5);
    poses.push_back(hand_pose(info, std::max(at_s, 0.0)));
  }
  if (moved_m(poses.front(), poses.back()) < kSharp_m) poses.assign(1, hand_pose(info, time_s));
  return poses;
}

/// Pose of the head, with the play that its encoders do not show: that of the first view at angles
/// zero, else its own at each place.
BoardPlace BoardStudio::State::place_before(const HeadMotion& head) const {
  const PanTiltUnit& unit = info.rig.pan_tilt;
  const auto step = [&](double angle_rad) {
    return static_cast<std::uint64_t>(std::llround(angle_rad / unit.step_rad) + (1LL << 32));
  };
  const auto play = [&](std::uint64_t axis) {
    const std::uint64_t key = hash_key(hash_key(info.options.seed, 0x91A7 + axis),
                                       step(head.angles.pan_rad), step(head.angles.tilt_rad));
    return std::sqrt(3.0) * unit.repeatability_rad * (2 * uniform(key) - 1);
  };
  BoardPlace place;
  place.pan_rad = whole_steps(unit, head.angles.pan_rad);
  place.tilt_rad = whole_steps(unit, head.angles.tilt_rad);
  place.target_from_board =
      geometry::inverse(rest_from_turned(unit, head.angles.pan_rad + head.swing_rad + play(0),
                                         head.angles.tilt_rad + play(1))) *
      board_place(info, 1).target_from_board;
  return place;
}

void BoardStudio::render_moment(int number, double time_s, const HeadMotion& head,
                                BoardView& view) {
  State& s = *state_;
  view.number = number;
  s.coarse_border = true;
  std::vector<geometry::Pose> color, taps;  // `taps` of the depth camera that is drawn
  if (s.info.options.pan_tilt) {
    const BoardPlace place = s.place_before(head);
    view.pan_rad = place.pan_rad, view.tilt_rad = place.tilt_rad;
    color = taps = {place.target_from_board};
    s.turn_to(place);
  } else {
    view.pan_rad = view.tilt_rad = 0;
    color = s.poses_about(time_s, kBoardExposure_s, kBlurSlices);
    s.turn_to({});
  }
  view.target_from_board = color[color.size() / 2];
  s.draw_color(s.target, {}, color, number, 1, s.behind_target, view.target);
  const auto poses_at = [&](const TofSensor& sensor) {
    if (!s.info.options.pan_tilt)
      taps = s.poses_about(time_s + sensor.delay_s, sensor.exposure_s, 4);
    return State::Poses(taps);
  };
  s.draw_tofs(poses_at, view);
}

void BoardStudio::render_fisheye(int number, double time_s, const HeadMotion& head,
                                 Image<Rgb8>& picture) {
  State& s = *state_;
  s.coarse_border = true;
  std::vector<geometry::Pose> poses;
  if (s.info.options.pan_tilt) {
    const BoardPlace place = s.place_before(head);
    poses = {place.target_from_board};
    s.turn_to(place);
  } else {
    poses = s.poses_about(time_s, kBoardExposure_s, kBlurSlices);
    s.turn_to({});
  }
  s.draw_color(s.fisheye, s.info.rig.target_from_fisheye, poses, number, 2, s.behind_fisheye,
               picture);
}

}  // namespace mixrig::studio

// SPDX-License-Identifier: Apache-2.0
// The analytic room as a compositor's setup: learned background, a virtual box, two lamps.
#pragma once

#include <vector>

#include "host/render/contract/compositor.h"
#include "tests/support/analytic_scene.h"

namespace mixrig::test {

/// Owns what a CompositorSetup borrows. World axes are those of the camera's first pose.
struct RoomSetup {
  struct Options {
    Size view{320, 240};
    Size tof{128, 96};
    bool objects = true, lamps = true, background = true, background_color = true;
    double lens_k1 = 0;
    bool second_tof = false;               ///< on the other side of the target camera
    Eigen::Vector3d box_m{0.3, 0.9, 2.9};  ///< centre of the virtual box, 0.6 m wide
  };
  explicit RoomSetup(const Options& options);
  RoomSetup(const RoomSetup&) = delete;
  RoomSetup& operator=(const RoomSetup&) = delete;

  AnalyticScene scene;
  Camera target, tof, tof2;
  render::CompositorSetup setup;
  Image<Rgb8> plate;    ///< with the person
  Image<float> depth;   ///< with the person
  Image<float> depth2;  ///< depth of the second ToF camera, with the person; empty without one
  render::FrameInput frame() const {
    return {.plate = plate, .tof_depth_m = depth, .world_from_target = {}, .tof2_depth_m = depth2};
  }
  /// Adds a horizontal square board to the learned background where the view sees it, `half_m` to
  /// each side of `at_m`. Precondition: a still background.
  void put_board(const Eigen::Vector3d& at_m, double half_m);
  /// Makes a part of the learned back wall a mirror whose depth has wrapped around. Precondition: a
  /// still background.
  void put_mirror();
  /// Draws the still background anew for each pose. Precondition: Options::background.
  void draw_background_for_each_pose();

 private:
  void learn(bool with_color);
  void add_box(const Eigen::Vector3d& center_m);

  Image<float> background_m_, background_sigma_m_, color_sigma_;
  Image<Rgbx8> learned_;
  Image<Rgbf> color_;
  Image<Rgb8> texture_;
  std::vector<glm::vec3> positions_, normals_;
  std::vector<glm::vec2> uv_;
  std::vector<std::uint32_t> indices_;
};

}  // namespace mixrig::test

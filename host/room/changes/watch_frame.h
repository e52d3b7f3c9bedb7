// SPDX-License-Identifier: Apache-2.0
// What a frame measured beside what the model of the room says, in one ideal view.
#pragma once

#include <Eigen/Core>

#include "hal/base/image.h"
#include "host/math/geometry/camera_model.h"
#include "host/math/geometry/depth_noise.h"
#include "host/math/geometry/pose.h"

namespace mixrig::model {

/// Borrowed; all images have the view's size.
struct WatchFrame {
  double time_s = 0;
  geometry::Pinhole view;
  geometry::Pose world_from_view;
  ImageView<const float> depth_m;        ///< measured z, 0 unknown
  ImageView<const Rgb8> color;           ///< sRGB, measured
  ImageView<const float> model_depth_m;  ///< 0 unknown
  ImageView<const Rgbf> model_color;     ///< linear, red negative: unknown; may be empty
};

/// A frame made ready to be compared. Borders of surfaces say nothing: there, half a pixel decides.
/// One thread; keeps its memory.
class FrameSight {
 public:
  explicit FrameSight(const geometry::DepthNoise& noise) : noise_(noise) {}
  void see(const WatchFrame& frame);
  const WatchFrame& frame() const { return frame_; }
  int width() const { return frame_.view.size_px.width; }
  int height() const { return frame_.view.size_px.height; }

  enum class Beside { kNothing, kSame, kNearer };
  /// What is measured at a pixel against the model's surfaces within kReach_px of it.
  Beside compare(int x, int y) const;
  /// Whether the model's surface at a pixel is not there: all that is measured within kReach_px of
  /// it is farther. Narrow parts count too, but not those of a single pixel.
  bool is_seen_through(int x, int y) const;
  /// Measured z, 0 where unknown or beside a step.
  float steady_m(int x, int y) const { return steady_m_.row(y)[x]; }
  /// Mean of the steady z of a pixel and of those around it on the same surface; 0 where unknown.
  float mean_m(int x, int y) const;
  /// Nearest of the measured z within kReach_px that have a neighbour on their surface; 0 without
  /// one.
  float nearest_m(int x, int y) const {
    const float z = seen_near_m_.row(y)[x];
    return z < kNoDepth_m ? z : 0;
  }
  /// z by which two surfaces at z must differ.
  float step_m(float z_m) const;
  Eigen::Vector3d world(int x, int y, float z_m) const;
  /// Pixel of a point of the world, and its z; false outside of the view.
  bool find(const Eigen::Vector3d& world_m, int& x, int& y, float& z_m) const;

  static constexpr int kReach_px = 2;

 private:
  static constexpr float kNoDepth_m = 1e9F;

  void spread_model();
  float shared_m(int x, int y) const;
  void spread_seen();
  void find_steady();
  int add_pairs(int x, int y, float& sum_w) const;

  geometry::DepthNoise noise_;
  WatchFrame frame_;
  geometry::Pose view_from_world_;
  Eigen::Matrix3d turn_;
  Image<float> steady_m_;
  Image<float> near_m_, far_m_;          ///< of the model within reach; near 0: one is unknown
  Image<float> shared_m_, seen_near_m_;  ///< measured, and the nearest of that within reach
  Image<float> row_near_m_, row_far_m_;  ///< along the row
};

}  // namespace mixrig::model

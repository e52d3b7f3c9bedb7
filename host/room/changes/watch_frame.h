// SPDX-License-Identifier: Apache-2.0
// Compares a frame's measurements with the model of the room, in one ideal view.
#pragma once

#include <Eigen/Core>

#include "hal/base/image.h"
#include "host/math/geometry/camera_model.h"
#include "host/math/geometry/depth_noise.h"
#include "host/math/geometry/pose.h"

namespace mixrig::model {

/// Inputs of a frame, borrowed; all images have the view's size.
struct WatchFrame {
  double time_s = 0;
  geometry::Pinhole view;
  geometry::Pose world_from_view;
  ImageView<const float> depth_m;        ///< measured z, 0 unknown
  ImageView<const Rgb8> color;           ///< measured, sRGB
  ImageView<const float> model_depth_m;  ///< 0 unknown
  ImageView<const Rgbf> model_color;     ///< linear, red negative: unknown; may be empty
};

/// Prepares a frame for comparison. Borders of surfaces are ignored, because half a pixel decides
/// there. For one thread; reuses its memory.
class FrameSight {
 public:
  explicit FrameSight(const geometry::DepthNoise& noise) : noise_(noise) {}
  void see(const WatchFrame& frame);
  const WatchFrame& frame() const { return frame_; }
  int width() const { return frame_.view.size_px.width; }
  int height() const { return frame_.view.size_px.height; }

  enum class Beside { kNothing, kSame, kNearer };
  /// Compares the measurement at a pixel with the model's surfaces within kReach_px of it.
  Beside compare(int x, int y) const;
  /// Whether the model's surface at a pixel is gone: everything measured within kReach_px is
  /// farther. Narrow surfaces count too, but not single pixels.
  bool is_seen_through(int x, int y) const;
  /// Measured z; 0 where unknown or beside a depth step.
  float steady_m(int x, int y) const { return steady_m_.row(y)[x]; }
  /// Mean of the steady z of a pixel and its neighbours on the same surface; 0 where unknown.
  float mean_m(int x, int y) const;
  /// Nearest measured z within kReach_px that has a neighbour on its surface; 0 if there is none.
  float nearest_m(int x, int y) const {
    const float z = seen_near_m_.row(y)[x];
    return z < kNoDepth_m ? z : 0;
  }
  /// Least difference in z between two surfaces at z.
  float step_m(float z_m) const;
  Eigen::Vector3d world(int x, int y, float z_m) const;
  /// Pixel and z of a world point; false outside the view.
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
  Image<float> near_m_, far_m_;  ///< of the model within reach; near 0: one of them is unknown
  Image<float> shared_m_, seen_near_m_;  ///< measured, and the nearest of it within reach
  Image<float> row_near_m_, row_far_m_;  ///< within reach along the row
};

}  // namespace mixrig::model

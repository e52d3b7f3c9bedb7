// SPDX-License-Identifier: Apache-2.0
// The empty analytic room as a background model of two faces that look left and right, ray-cast.
#pragma once

#include <cmath>
#include <cstdint>

#include "hal/base/learned_color.h"
#include "host/render/contract/compositor.h"
#include "tests/support/analytic_scene.h"

namespace mixrig::test {

/// Both faces see what is straight ahead. Owns what model() borrows.
class FaceModel {
 public:
  explicit FaceModel(AnalyticScene room, int color_factor = 2,
                     const Eigen::Vector3d& place_m = {0, 0, 0})
      : color_factor_(color_factor), place_m_(place_m) {
    room.person = false;
    depth_m_.reset({kSide, 2 * kSide});
    sigma_m_.reset(depth_m_.size(), 0.005F);
    color_.reset({color_factor * kSide, 2 * color_factor * kSide});
    for (int face = 0; face < 2; ++face) {
      for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) {
          const Hit hit = cast(room, place_m_, ray(face, x, y));
          depth_m_.at(x, face * kSide + y) = static_cast<float>(hit.t);
        }
      const int side = color_factor * kSide;
      for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) color_.at(x, face * side + y) = mean_color(room, face, x, y);
    }
  }

  render::BackgroundModel model() const {
    render::BackgroundModel model;
    model.camera = {{kSide, kSide}, kFocal_px, kFocal_px, kMiddle_px, kMiddle_px};
    for (const int face : {0, 1})
      model.world_from_face.push_back({Eigen::Quaterniond(turn(face)), place_m_});
    model.depth_m = depth_m_, model.depth_sigma_m = sigma_m_, model.color = color_;
    model.color_factor = color_factor_;
    return model;
  }

 private:
  static constexpr int kSide = 201;
  static constexpr double kFocal_px = 150, kMiddle_px = 0.5 * (kSide - 1), kTurn_rad = 0.4;

  static Eigen::Matrix3d turn(int face) {
    const double angle = face == 0 ? -kTurn_rad : kTurn_rad;
    return Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()).toRotationMatrix();
  }
  /// Ray of a pixel of a face, with length 1 along the face's axis.
  static Eigen::Vector3d ray(int face, double x, double y) {
    return turn(face) *
           Eigen::Vector3d((x - kMiddle_px) / kFocal_px, (y - kMiddle_px) / kFocal_px, 1);
  }
  /// Mean albedo of 2x2 samples in a pixel of the colour.
  Rgbx8 mean_color(const AnalyticScene& room, int face, int x, int y) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const double dx : {0.25, 0.75})
      for (const double dy : {0.25, 0.75})
        sum +=
            0.25 * cast(room, place_m_,
                        ray(face, (x + dx) / color_factor_ - 0.5, (y + dy) / color_factor_ - 0.5))
                       .albedo;
    const auto c = sum.cast<float>().eval();
    return learned_color({c.x(), c.y(), c.z()}, 0.01F);
  }

  int color_factor_;
  Eigen::Vector3d place_m_;
  Image<float> depth_m_, sigma_m_;
  Image<Rgbx8> color_;
};

}  // namespace mixrig::test

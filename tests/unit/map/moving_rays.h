// SPDX-License-Identifier: Apache-2.0
// Random points and a camera that moves past them, as tracks of pixels by formula, without
// pictures.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "extras/map/reconstruction/features/feature_tracks.h"
#include "host/math/geometry/any_camera.h"

namespace mixrig::test {

/// An equidistant fisheye.
inline geometry::AnyCamera wide_camera() {
  return geometry::FisheyeModel({{640, 512}, 155, 155, 320, 256, {}});
}

struct MovingRays {
  int pictures = 12, places = 250;
  double step_m = 0.05;    ///< sideways movement per picture
  double step_rad = 0.02;  ///< turn about the vertical per picture
  double noise_px = 0.2;
  double wrong_share = 0;  ///< share of tracks without a point: random pixels in each picture
  bool flat = false;       ///< all points lie on a wall
  unsigned seed = 1;

  geometry::Pose world_from_camera(int picture) const {
    return {Eigen::Quaterniond(Eigen::AngleAxisd(step_rad * picture, Eigen::Vector3d::UnitY())),
            {step_m * picture, 0.3 * step_m * std::sin(0.7 * picture), 0.2 * step_m * picture}};
  }

  reconstruction::FeatureTracks tracks(const geometry::AnyCamera& camera) const {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(-1, 1);
    std::normal_distribution<double> noise(0, noise_px);
    reconstruction::FeatureTracks all;
    for (int i = 0; i < pictures; ++i) {
      all.times_s.push_back(0.1 * i);
      reconstruction::KeyPicture key;
      key.picture = i;
      key.grey.reset({8, 8});
      all.keys.push_back(std::move(key));
    }
    for (int p = 0; p < places; ++p) {
      const Eigen::Vector3d place(2 * unit(random), 1.5 * unit(random),
                                  flat ? 2.5 : 2.5 + unit(random));
      const bool wrong = p < wrong_share * places;
      reconstruction::FeatureTrack track;
      for (int i = 0; i < pictures; ++i) {
        const auto px = geometry::project(camera, geometry::inverse(world_from_camera(i)) * place);
        if (!px) continue;
        Eigen::Vector2d at = *px + Eigen::Vector2d(noise(random), noise(random));
        if (wrong) at += Eigen::Vector2d(40 * unit(random), 40 * unit(random));
        track.seen.push_back({i, at, 0.3});
      }
      all.tracks.push_back(std::move(track));
    }
    return all;
  }
};

}  // namespace mixrig::test

// SPDX-License-Identifier: Apache-2.0
// The true scene of a capture, as rendered by the studio.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "hal/base/image.h"
#include "host/math/geometry/camera_model.h"

namespace mixrig::capture {

/// The ideal view of a frame whose lens moved, and its entrance pupil before the camera's origin.
struct TrueLens {
  geometry::Pinhole view;
  double pupil_shift_m = 0;
};

/// Where one person is, and how much of it the view shows.
struct TruePerson {
  int number = 0;           ///< of the person, from 0 on
  double x_m = 0, y_m = 0;  ///< world, vertically below the middle of the hip joints
  double top_m = 0;         ///< the highest point of the body over the floor
  double visible_m2 = 0;    ///< what is seen, each pixel as large as at its own depth
  bool operator==(const TruePerson&) const = default;
};

/// All images in the ideal view.
struct Truth {
  static constexpr std::uint8_t kLayerMask = 3;  ///< visible: 0 background, 1 person, 2 virtual
  static constexpr std::uint8_t kTofSees = 4;    ///< the ToF camera sees the real surface
  static constexpr std::uint8_t kVirtual =
      8;  ///< inside the virtual objects' silhouette, occluded or not
  static constexpr std::uint8_t kTof2Sees = 16;  ///< as kTofSees, of a second ToF camera

  Image<float> depth_m;       ///< of the real scene
  Image<std::uint8_t> matte;  ///< coverage by people, 255 = all
  Image<float> light;         ///< light with / light without virtual objects
  Image<Rgb8> composite;
  Image<std::uint8_t> labels;      ///< the bits above
  std::vector<TruePerson> people;  ///< who is in the room, seen or not
  std::optional<TrueLens> lens;    ///< where the lens moves; else the view is that of the source
};

}  // namespace mixrig::capture

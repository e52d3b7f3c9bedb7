// SPDX-License-Identifier: Apache-2.0
// The true scene of a capture, as rendered by the studio.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "hal/base/image.h"
#include "host/math/geometry/camera_model.h"

namespace mixrig::capture {

/// The ideal view of a frame whose lens moved, and how far its entrance pupil lies ahead of the
/// camera's origin.
struct TrueLens {
  geometry::Pinhole view;
  double pupil_shift_m = 0;
};

/// True place of one person, and how much of them the view shows.
struct TruePerson {
  int number = 0;           ///< number of the person, from 0
  double x_m = 0, y_m = 0;  ///< world, vertically below the middle of the hip joints
  double top_m = 0;         ///< the highest point of the body over the floor
  double visible_m2 = 0;    ///< visible area: each pixel has its size at its own depth
  bool operator==(const TruePerson&) const = default;
};

/// Truth of a capture; all images are in the ideal view.
struct Truth {
  static constexpr std::uint8_t kLayerMask = 3;  ///< visible: 0 background, 1 person, 2 virtual
  static constexpr std::uint8_t kTofSees = 4;    ///< the ToF camera sees the real surface
  static constexpr std::uint8_t kVirtual =
      8;  ///< inside the virtual objects' silhouette, occluded or not
  static constexpr std::uint8_t kTof2Sees = 16;  ///< a second ToF camera sees the real surface

  Image<float> depth_m;       ///< depth of the real scene
  Image<std::uint8_t> matte;  ///< coverage by people, 255 = all
  Image<float> light;         ///< light with / light without virtual objects
  Image<Rgb8> composite;
  Image<std::uint8_t> labels;      ///< the bits above
  std::vector<TruePerson> people;  ///< people in the room, visible or not
  std::optional<TrueLens> lens;    ///< only if the lens moves; else the view is the source's
};

}  // namespace mixrig::capture

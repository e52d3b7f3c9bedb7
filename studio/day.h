// SPDX-License-Identifier: Apache-2.0
// Changes since the room was scanned or its background learned.
#pragma once

#include <optional>

namespace mixrig::studio {

/// One lamp of the room, from 1 on, that is set to `level` of what it was at a time of the take.
struct LampDim {
  int lamp = 1;
  double from_s = 0, level = 0;
};

struct Day {
  int crowd = 0;          ///< people who stand 0.8 m before the camera, 0..8, beside the others
  double lamp_level = 1;  ///< level of all lamps, 0..2; 0.15 of the ambient light is not theirs
  std::optional<double> lights_out_s;  ///< time of the take from which lamp_level is 0
  std::optional<LampDim> dim;          ///< what others reflect of its light stays
  bool moved_chair = false;            ///< the chair of the desk is moved
  bool swinging_door = false;          ///< opens by 75 degrees and closes every 6 seconds

  /// Whether room or light change during a take.
  bool changes() const { return lights_out_s || swinging_door; }
};

}  // namespace mixrig::studio

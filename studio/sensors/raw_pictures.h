// SPDX-License-Identifier: Apache-2.0
// The raw pictures of a Kinect v2: three modulation frequencies, three phase steps each, as it
// packs and sends them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "hal/base/image.h"
#include "studio/rig.h"
#include "studio/sensors/noise.h"
#include "studio/sensors/tof.h"

namespace mixrig::studio {

/// The kinect2 preset with the frequencies whose unambiguous ranges are 1.875, 9.375 and 1.25 m
/// (about 80, 16 and 120 MHz), and its light source beside the lens. Without the systematic phase
/// error of the preset's own output: what is left of it after the factory's correction is not part
/// of the raw pictures' model.
TofSensor raw_sensor(TofSensor kinect2);

/// Forward model of a pixel and one exposure of a phase-shift ToF sensor (Lange and Seitz 2001,
/// section II, for three steps): the two taps collect
///   0.5 signal (strength + c) and 0.5 signal (strength - c), and the room light each, with
///   c = contrast_f * sum over the footprint of strength cos(phase_f - offset_f + 2 pi k / 3),
/// and photon and read noise of their own; their difference is sent, in counts. The room light
/// cancels, its noise does not. A tap over the full well makes the sample the code for saturation.
/// How samples are packed (11 bits with sign and exponent, the order of columns and rows, the
/// mirrored picture, the footer) and the step of the phase offsets: facts of libfreenect2 at
/// fd64c5d. The tenth picture, of no published meaning, is zero.
class RawPictures {
 public:
  RawPictures(const TofSensor& sensor, unsigned seed);

  /// Ten sub-packets with footers. `taps`: light of all pixels, row by row, at four times of the
  /// exposure; the nine exposures are at the nearest of them. `key` seeds the noise.
  void expose(std::span<const std::array<Echo, 4>> taps, std::uint64_t key, int number,
              double time_s, std::vector<std::uint8_t>& out) const;
  RawTables tables() const;

 private:
  std::uint16_t sample(const Echo& light, int frequency, int step, std::size_t pixel,
                       std::uint64_t bits) const;

  TofSensor sensor_;
  std::array<std::vector<std::uint16_t>, 3> offsets_;  ///< of each frequency, steps, as we see
  NormalTable normal_;
};

}  // namespace mixrig::studio

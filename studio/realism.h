// SPDX-License-Identifier: Apache-2.0
// Switches for effects that the studio models in addition to its plain look.
// docs/reference/studio.md lists them.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "hal/base/result.h"

namespace mixrig::studio {

/// One switch for each effect; the plain look has all off.
struct Realism {
  // Colour camera.
  bool mosaic = false;           ///< Bayer filter, shot and read noise of one channel a pixel
  bool chroma = false;           ///< 4:2:2
  bool gain_drift = false;       ///< exposure and white balance change slowly
  bool vignetting = false;       ///< darker corners
  bool motion_blur = false;      ///< exposed for 8 ms
  bool rolling_shutter = false;  ///< the last row is exposed 12 ms after the first
  bool defocus = false;          ///< thin lens, focused at 2.8 m
  // Depth camera.
  bool multipath = false;      ///< one bounce of the modulated light
  bool stray_light = false;    ///< a share of the mean phasor in every pixel
  bool pixel_offsets = false;  ///< fixed pattern of the distance
  bool warm_up = false;        ///< distances drift with the temperature
  bool harmonics = false;      ///< the systematic error has a second harmonic, not corrected
  bool late_depth = false;     ///< exposed 6 ms after the colour camera
  // Light.
  bool bounce = false;  ///< diffuse light of one reflection
  bool gloss = false;   ///< the floor and the glazed pictures reflect
  bool mirror = false;  ///< a mirror on the far wall
  // People.
  bool hair = false;           ///< strands around the head
  bool loose_clothes = false;  ///< an open jacket that swings

  bool operator==(const Realism&) const = default;
  static Realism all();
  /// Whether the colour camera differs from the plain one.
  bool shows_in_the_plate() const {
    return mosaic || chroma || gain_drift || vignetting || motion_blur || rolling_shutter ||
           defocus;
  }
};

struct NamedSwitch {
  std::string_view name;
  bool Realism::*on;
};
std::span<const NamedSwitch> realism_switches();
/// The switches named in a list with commas. Errors: kUsage; the line lists the names that exist.
Result<Realism> parse_realism(std::string_view list);
/// `from` without the switches that are on in `without`.
Realism minus(Realism from, const Realism& without);
/// Names of the switches that are on, with commas; "plain" for none.
std::string names_of(const Realism& realism);

}  // namespace mixrig::studio

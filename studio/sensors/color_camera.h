// SPDX-License-Identifier: Apache-2.0
// The target camera from light to an sRGB picture: defocus, vignetting, gains, Bayer filter, noise.
#pragma once

#include "hal/base/parallel.h"
#include "studio/realism.h"
#include "studio/sensors/lens.h"
#include "studio/sensors/noise.h"
#include "studio/stage/mesh.h"

namespace mixrig::studio {

struct ColorSensor {
  float full_well_e = 12000, read_noise_e = 8;
  float levels = 4095;                ///< of the converter, at full well
  Vec3 response{0.52F, 1.0F, 0.68F};  ///< of red, green and blue pixels to white light
  float aperture_m = 0.0046F;         ///< diameter of the entrance pupil
  float focus_m = 2.8F;               ///< distance that is sharp
  float falloff = 1.6F;               ///< light falls with cos^falloff of the angle to the axis
  float exposure_s = 8e-3F, readout_s = 12e-3F;  ///< of a row; from the first row to the last
};

/// Factors of the camera's automatic control at a time, on light and on red and blue.
struct Gain {
  float exposure = 1, red = 1, blue = 1;
};
/// Gain at a time: at most 0.12 of an f-stop and 3 % of colour from 1; changes by at most a third
/// of that in a frame. 1 at time 0.
Gain gain_at(unsigned seed, double time_s);

/// Diameter of the circle of confusion of a thin lens, px: A f |1/z - 1/focus|.
float blur_circle_px(const ColorSensor& sensor, float f_px, float z_m);
/// Spreads each pixel over its circle of confusion, at most 16 px wide. `z_m` has kMiss (1e9) where
/// nothing is seen. Light from behind does not spread over what is nearer and sharper.
void defocus(const ColorSensor& sensor, float f_px, const Image<Rgbf>& light,
             const Image<float>& z_m, Crew& crew, Image<Rgbf>& blurred);

/// 0 red, 1 green, 2 blue: RGGB.
inline int bayer_channel(int x, int y) { return (x & 1) + (y & 1); }
/// One channel a pixel, 1 = full well: photons and read noise (sigma^2 = charge + read^2), clipped
/// and converted.
void expose(const ColorSensor& sensor, const Image<Rgbf>& light, std::uint64_t key,
            const NormalTable& normal, Crew& crew, Image<float>& raw);
/// Malvar, He and Cutler 2004: the four linear 5 x 5 filters. `raw` is mirrored at its borders.
Rgbf demosaic_at(ImageView<const float> raw, int x, int y);
/// Leaves each pair of pixels in a row one chroma (4:2:2; Y'CbCr of ITU-R BT.601, whole range).
void halve_chroma(Image<Rgb8>& picture, Crew& crew);

/// Makes the picture of a frame. Not thread-safe: reuses memory.
class ColorCamera {
 public:
  ColorCamera(const Optics& optics, const Realism& realism, unsigned seed);

  const ColorSensor& sensor() const { return sensor_; }
  void set_focus(float focus_m) { sensor_.focus_m = focus_m; }
  /// `light` is linear with the take's exposure, 1 = white; it is used up.
  void develop(Image<Rgbf>& light, const Image<float>& z_m, int number, double time_s, Crew& crew,
               Image<Rgb8>& picture);

 private:
  /// Vignetting and automatic exposure.
  void attenuate(Image<Rgbf>& light, float exposure, Crew& crew) const;

  ColorSensor sensor_;
  Optics optics_;
  Realism realism_;
  unsigned seed_;
  NormalTable normal_;
  RayGrid rays_;
  Image<Rgbf> blurred_;
  Image<float> raw_;
};

}  // namespace mixrig::studio

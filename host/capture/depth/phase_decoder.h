// SPDX-License-Identifier: Apache-2.0
// Distances from the raw pictures of a phase camera with three modulation frequencies.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "hal/base/image.h"
#include "hal/wire/camera/kinect2_raw.h"
#include "host/capture/depth/bounced_light.h"
#include "host/math/geometry/camera_model.h"

namespace mixrig::depth {

/// Constants of a phase camera. Arrays are in the order of the frequencies of its pictures.
struct PhaseCamera {
  geometry::CameraModel lens;                ///< as the device reports it
  std::array<Image<float>, 3> offset_turns;  ///< phase offset of each pixel
  std::array<double, 3> range_m{};           ///< unambiguous range of each frequency
  std::array<double, 3> contrast{};          ///< amplitude per light at each frequency
  /// How far the light source lies right of the centre of projection.
  double light_x_m = 0;
  double read_variance = 0;       ///< variance of a sample without light, counts^2
  double variance_per_light = 0;  ///< variance of a sample per count of light, counts^2
  double phase_floor_turns = 0;   ///< sigma of a phase that remains however strong the light
  double longest_m = 0;           ///< half of the longest light path that is considered
};

/// Ranges of 1.875, 9.375 and 1.25 m, relative contrasts and 45 mm to the light source follow from
/// constants of libfreenect2 (at fd64c5d). The noise is that of the virtual studio: none is
/// published.
PhaseCamera kinect2_phase_camera(const device::Kinect2Infrared& infrared,
                                 const device::Kinect2Offsets& offsets);

/// Quality of a pixel's value.
enum class PixelState : std::uint8_t {
  kGood,
  kDark,       ///< too little light comes back: no distance
  kSaturated,  ///< no distance
  kMixed,      ///< its phases, its amplitudes or its neighbours contradict it: surfaces at several
               ///< distances share the pixel, or light came on several ways
};

/// Pictures of the camera's size, reused from frame to frame.
struct PhaseDepth {
  Image<float> distance_m;  ///< along the ray, from the centre of projection; 0: none
  Image<float> sigma_m;     ///< its standard deviation by the noise of the samples, and a third of
                            ///< what step 5 changed
  Image<float> amplitude;   ///< returned light, 0 to 65535
  Image<float> confidence;  ///< 0 to 1; below kLeastConfidence exactly if the pixel is not kGood
  Image<PixelState> state;
};
inline constexpr float kLeastConfidence = 0.5F;

/// Decodes frames. For each pixel
/// 1. the phase of each frequency from its three samples (Lange and Seitz 2001, section II), its
///    variance from the light;
/// 2. for every number of wraps of the first frequency the wraps of the others that fit best, the
///    weighted mean of the three distances, and the squared residuals over their variances: chi^2
///    with two degrees of freedom. The minimum is the maximum likelihood over the wraps; its
///    distance to the second best says how certain the wraps are;
/// 3. the test whether amplitudes over their contrasts agree, as they do where one surface is seen
///    (chi^2 with two more degrees of freedom);
/// 4. the test whether neighbours agree, as they do on a surface, and the mean of those within the
///    noise, weighted by their variances, in 3x3 pixels;
/// 5. the correction of multipath (BouncedLight) from means over the surface pixels of a window.
/// Not thread-safe. Allocates nothing after construction.
class PhaseDecoder {
 public:
  explicit PhaseDecoder(const PhaseCamera& camera);

  /// Decodes one frame; `pictures` has kKinect2RawBytes.
  void decode(std::span<const std::uint8_t> pictures, PhaseDepth& out);
  /// Switches step 5, the correction of multipath; on by default.
  void set_bounced_light(bool on) { bounced_on_ = on; }
  /// Switches the mean of step 4; on by default. Without it the noise is that of single pixels.
  void set_smoothing(bool on) { smoothing_ = on; }

 private:
  static constexpr int kColumns = device::kKinect2Depth.width;
  /// Chi^2 with four degrees of freedom: exceeded with p = 0.09.
  static constexpr float kMostMisfit = 8;
  static constexpr float kLeastMargin = 6;  ///< least difference of chi^2 to the second best wraps
  using Row = std::array<float, kColumns>;
  struct PhaseRow;
  struct SurfaceMeans;
  void measure_phases(std::span<const std::uint8_t> pictures, int y, PhaseRow& row) const;
  void weigh(int y, PhaseRow& row);
  void unwrap(int y, PhaseRow& row);
  void decode_row(std::span<const std::uint8_t> pictures, int y);
  void judge_row(int y, PhaseDepth& out);
  void correct_bounced(PhaseDepth& out) const;
  void correct_row(int y, const SurfaceMeans& means, PhaseDepth& out) const;

  Size size_;
  std::array<float, 3> range_m_, scale_, sigma_scale_;
  float read_variance_, variance_per_light_, floor_variance_turns_, light_m_;
  int wraps_;
  bool smoothing_ = true, bounced_on_ = true;
  BouncedLight bounced_;
  std::array<Image<float>, 3> offset_turns_;
  Image<float> light_along_m_;  ///< position of the light source along each pixel's ray
  // Values of the present frame, by pixel.
  Image<float> way_m_, variance_m2_, misfit_, margin_, light_;
  Image<PixelState> state_;
  // For step 5: surface_ is 1 if the pixel belongs to a surface, else 0; the others compare
  // distance and light between the frequencies.
  Image<float> surface_, fine_m_, coarse_m_, spread_m_, fine_light_, first_light_;
};

}  // namespace mixrig::depth

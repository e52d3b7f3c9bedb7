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

/// What is known of the camera. Frequencies in the order of the pictures.
struct PhaseCamera {
  geometry::CameraModel lens;                ///< as the device tells it
  std::array<Image<float>, 3> offset_turns;  ///< of each pixel's phase
  std::array<double, 3> range_m{};           ///< unambiguous range of each frequency
  std::array<double, 3> contrast{};          ///< amplitude per light at each frequency
  double light_x_m = 0;           ///< the light source is so far right of the centre of projection
  double read_variance = 0;       ///< of a sample, counts^2, without light
  double variance_per_light = 0;  ///< of a sample, counts^2 per count of light
  double phase_floor_turns = 0;   ///< sigma of a phase that no light makes better
  double longest_m = 0;           ///< half of the longest way that is looked for
};

/// Ranges of 1.875, 9.375 and 1.25 m, relative contrasts and 45 mm to the light source follow from
/// constants of libfreenect2 (at fd64c5d). The noise is that of the virtual studio: none is
/// published.
PhaseCamera kinect2_phase_camera(const device::Kinect2Infrared& infrared,
                                 const device::Kinect2Offsets& offsets);

/// What a pixel's value is worth.
enum class PixelState : std::uint8_t {
  kGood,
  kDark,       ///< too little light comes back: no distance
  kSaturated,  ///< no distance
  kMixed,      ///< its phases, its amplitudes or its neighbours contradict it: surfaces at several
               ///< distances share the pixel, or light came on several ways
};

/// Pictures of the camera's size, reused from frame to frame.
struct PhaseDepth {
  Image<float> distance_m;  ///< along the ray, from the centre of projection; 0 where there is none
  Image<float> sigma_m;     ///< its standard deviation by the noise of the samples, and a third of
                            ///< what step 5 changed
  Image<float> amplitude;   ///< light that comes back, 0 to 65535
  Image<float> confidence;  ///< 0 to 1; below kLeastConfidence exactly where it is not good
  Image<PixelState> state;
};
inline constexpr float kLeastConfidence = 0.5F;

/// Decodes frames. For each pixel
/// 1. the phase of each frequency from its three samples (Lange and Seitz 2001, section II), its
///    variance from the light;
/// 2. for every number of wraps of the first frequency the wraps of the others that fit best, the
///    weighted mean of the three distances, and what is left of them over their variances: chi^2
///    of two degrees of freedom. The least is the maximum of the likelihood over the wraps; its
///    distance to the second is how sure the wraps are;
/// 3. amplitudes over their contrasts agree where one surface is seen (chi^2 of two more);
/// 4. neighbours: a surface has others beside it; a mean over those within the noise, weighted by
///    their variances, in 3x3 pixels.
/// Not thread-safe. Allocates nothing after construction.
class PhaseDecoder {
 public:
  explicit PhaseDecoder(const PhaseCamera& camera);

  /// `pictures`: kKinect2RawBytes.
  void decode(std::span<const std::uint8_t> pictures, PhaseDepth& out);
  /// Step 5; on by default.
  void set_bounced_light(bool on) { bounced_on_ = on; }
  /// The same without step 4's mean: noise as of single pixels.
  void set_smoothing(bool on) { smoothing_ = on; }

 private:
  static constexpr int kColumns = device::kKinect2Depth.width;
  static constexpr float kMostMisfit = 8;   ///< chi^2 of four degrees of freedom: 0.09 by chance
  static constexpr float kLeastMargin = 6;  ///< of chi^2 to the second best wraps
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
  Image<float> light_along_m_;  ///< light source along each pixel's ray
  // Of the frame, single pixels.
  Image<float> way_m_, variance_m2_, misfit_, margin_, light_;
  Image<PixelState> state_;
  // For step 5: 1 and what tells the frequencies apart where a pixel is one of a surface, else 0.
  Image<float> surface_, fine_m_, coarse_m_, spread_m_, fine_light_, first_light_;
};

}  // namespace mixrig::depth

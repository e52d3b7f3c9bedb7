// SPDX-License-Identifier: Apache-2.0
// What a depth camera errs by, measured in its own pictures without truth.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "host/capture/depth/seen_corners.h"

namespace mixrig::depth {

/// Noise of a pixel in the cells whose depth lies in an interval, medians of the cells.
struct NoiseRow {
  double from_m = 0, to_m = 0;
  std::size_t cells = 0;
  double spatial_m = 0;   ///< about a plane through the cell: also a fixed pattern and steps of the
                          ///< depth; a driver that smooths lowers it
  double temporal_m = 0;  ///< between successive pictures; 0: not measured
  double amplitude = 0;   ///< 0: none
};

struct DepthFigures {
  std::size_t pictures = 0;
  double unknown_share = 0;      ///< of the pixels that have a ray
  bool moves = false;            ///< the camera moves, so that temporal noise is unknown
  std::vector<NoiseRow> noise;   ///< intervals of at least kFewestNoiseCells
  std::vector<Flatness> planes;  ///< of all pictures
  std::vector<SeenCorner> corners;
  /// At steps of more than a tenth of the depth, of three pixels across the step: how many lie
  /// between both surfaces, and how many are unknown, in the mean.
  double flying_pixels = 0, unknown_pixels = 0;
  std::size_t steps = 0;
};

inline constexpr std::size_t kFewestNoiseCells = 30;

/// Collects figures over the pictures of one camera. Memory grows with the pictures. Not
/// thread-safe.
class DepthMeter {
 public:
  explicit DepthMeter(const geometry::CameraModel& camera) : rays_(camera) {}

  /// Adds a picture. `z_m`: along the axis, of the camera's size; unknown where not positive or not
  /// finite. `amplitude`, and `next_m`, the picture taken next: empty, or of the same size.
  void add(ImageView<const float> z_m, ImageView<const float> amplitude,
           ImageView<const float> next_m);
  DepthFigures figures() const;
  const PixelRays& rays() const { return rays_; }

 private:
  /// Limits of the intervals of depth, metres.
  static constexpr std::array<double, 9> kLimits_m{0, 0.75, 1, 1.5, 2, 3, 4, 6, 10};
  struct Samples {
    std::vector<float> spatial_m, temporal_m, amplitude;
  };
  void add_noise(const CellGrid& grid, ImageView<const float> z_m, ImageView<const float> amplitude,
                 ImageView<const float> next_m);
  void add_steps(ImageView<const float> z_m, int dx, int dy);
  void count_unknown(ImageView<const float> z_m);

  PixelRays rays_;
  std::array<Samples, kLimits_m.size() - 1> samples_;
  std::vector<Flatness> planes_;
  std::vector<SeenCorner> corners_;
  std::size_t pictures_ = 0, pixels_ = 0, unknown_ = 0;
  std::size_t steps_ = 0, flying_ = 0, unknown_at_steps_ = 0;
};

}  // namespace mixrig::depth

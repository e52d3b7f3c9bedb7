// SPDX-License-Identifier: Apache-2.0
// Measures how near the seen surface of people is to an object.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "extras/people/touch/contact.h"
#include "extras/people/touch/moment.h"
#include "extras/people/touch/shape.h"

namespace mixrig::touch {

/// Takes the pixels around an object as points of people. A point counts where neighbouring pixels
/// show the same surface, which excludes depth between a person and the room. The gap is that of
/// the nearest patch of 8 cm^2, each pixel counted at its size at its depth. One thread; no
/// allocation once the buffers have grown.
class SurfaceGaps {
 public:
  /// Gap of each person of the moment; nullopt: no part of the person is near.
  std::span<const std::optional<Gap>> measure(const Shape& shape,
                                              const geometry::Pose& world_from_object,
                                              const Moment& moment);

 private:
  static constexpr float kBin_m = 0.005F, kDeepest_m = -0.5F;
  static constexpr int kBins = 150;  ///< from kDeepest_m to kNear_m
  struct Sample {
    Eigen::Vector3f at_m;
    float area_m2 = 0, distance_m = 0, facing = 0;  ///< cosine between ray and nearest face
    int patch = 0, who = 0;
  };
  /// Surface of one person in one cell.
  struct Patch {
    float area_m2 = 0, facing = 0;
    Eigen::Vector3f sum_m = Eigen::Vector3f::Zero();  ///< places times areas
    int points = 0;
  };
  struct Window {
    int x0, y0, x1, y1, step;
  };
  std::optional<Window> window(const Shape& shape, const geometry::Pose& view_from_object,
                               const plan::SegmentedView& seen) const;
  void own(const Shape& shape, const geometry::Pose& world_from_object, const Moment& moment);
  int owner(const Eigen::Vector3f& at_m, const Moment& moment) const;
  void collect(const Shape& shape, const geometry::Pose& world_from_object, const Moment& moment,
               const Window& window);
  void order();
  void find_patches(double depth_sigma_m);

  std::vector<Sample> samples_, ordered_;  ///< the second from the deepest on, to half a centimetre
  std::array<int, kBins + 1> first_{};
  std::vector<Patch> patches_;  ///< of each person, in a grid around the object
  Eigen::Vector3i patch_cells_ = Eigen::Vector3i::Zero();
  float patch_m_ = 0;
  std::vector<std::optional<Gap>> gaps_;
  std::vector<signed char> owner_;  ///< person of each cell in a plan around the object
  Eigen::Vector2f corner_m_ = Eigen::Vector2f::Zero();
  int columns_ = 0, rows_ = 0;
};

}  // namespace mixrig::touch

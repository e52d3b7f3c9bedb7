// SPDX-License-Identifier: Apache-2.0
// How people move in the view from one frame to the next. Host, shared by both back ends.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "hal/base/image.h"
#include "hal/base/parallel.h"
#include "host/render/contract/compositor.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render {

/// A sparse picture of people: a sample is the mean of kMotionPoints squared places of the plate.
struct PeopleSamples {
  Image<float> light;  ///< 0..255, not linear, with a margin of kMotionReach samples on all sides
  Image<float> w;      ///< 1/m, of the nearest person measured there; 0: none
};
/// Samples to either side within which motion is looked for, a frame.
inline constexpr int kMotionReach = 8;
/// Samples a cell's side; each cell has one motion.
inline constexpr int kMotionCell = 4;
inline constexpr int kMotionPoints = 4;

/// Motion between two sparse pictures. People connected in depth are a cluster; its motion is the
/// shift that most of its samples agree on (least sum of absolute differences), that of a cell the
/// same around it within two samples, over 3x3 cells of the cluster. Memory of one compositor.
class ClusterMotion {
 public:
  explicit ClusterMotion(Size samples);
  Size cells() const { return cells_; }
  /// Motion of each cell in samples a frame, from `before` to `now`, both of the size given first;
  /// 0 where nobody is. Cells within two of people move as the nearest of these. Allocates nothing.
  const Image<glm::vec2>& find(const PeopleSamples& now, const PeopleSamples& before);
  /// Cells that move as people do, after find(): within two of people.
  bool near_people(int x, int y) const { return spread_.row(y)[x] > 0; }

 private:
  static constexpr int kSide = 2 * kMotionReach + 1, kLocal = 5;
  struct Place {
    int x, y;
  };
  void label(const PeopleSamples& now);
  void grow(Place from, std::uint8_t label);
  void move_cluster(const PeopleSamples& now, const PeopleSamples& before, std::uint8_t label);
  glm::ivec2 best_of_cluster(const PeopleSamples& now, const PeopleSamples& before);
  void cost_of_cell(const PeopleSamples& now, const PeopleSamples& before, Place cell,
                    glm::ivec2 around);
  glm::vec2 best_of_cell(Place cell, glm::ivec2 around, std::uint8_t label) const;
  void spread();

  Size size_, cells_;
  Image<float> cell_w_;  ///< mean of people; 0: none
  Image<std::uint8_t> label_, spread_, next_spread_;
  Image<glm::vec2> motion_;
  std::vector<Place> cluster_;                                 ///< cells of the cluster looked at
  std::vector<std::array<float, kLocal * kLocal + 1>> costs_;  ///< of each cell; last: samples
};

/// Share of the matte before where the plate is the same; and by how much the roots of light, of
/// 255, differ in the mean over channels and 3x3 pixels where it is a share of 1/e of that: some
/// times the noise of a sensor. docs/method/compositor.md, "Refine".
inline constexpr float kBeforeShare = 0.7F;
inline constexpr float kAlike = 8;

/// Whether the key of this setup follows people: against a background that stands still.
bool follows_people(const CompositorSetup& setup);

/// Samples people and plate of each frame, and says how they moved since the one before. Not
/// thread-safe.
class PeopleMotion {
 public:
  /// Reads plate_px, tof_ray and key_limit_w of `tables` now. Precondition: these hold for all
  /// frames.
  explicit PeopleMotion(const Tables& tables);
  /// Takes a frame; false where it is the last one once more. Allocates nothing. What was seen
  /// before counts only where the camera stands as it stood then, and at most kPause_s before.
  bool see(const FrameInput& input, Crew& crew);
  int cell_px() const { return kMotionCell * step_px_; }
  Size cells() const { return clusters_.cells(); }
  /// Motion of each cell since the frame before, pixels of the view; null: not known.
  const Image<glm::vec2>* motion_px() const { return known_ ? &motion_px_ : nullptr; }
  /// By how many whole pixels people's depth is moved to where they were at the time of the plate,
  /// for each cell. False where it stays everywhere.
  bool depth_shift_px(double depth_delay_s, Image<glm::vec2>& shift) const;
  static constexpr double kPause_s = 0.25;

 private:
  void sample_light(ImageView<const Rgb8> plate, Crew& crew);
  void sample_light_row(ImageView<const Rgb8> plate, int y, float* light) const;
  void sample_people(ImageView<const float> tof_depth_m);

  /// A place of the ToF picture.
  struct Ray {
    int x, y;
    glm::vec3 per_value;  ///< a measured value times this is the place, metres, axes of the camera
  };

  const Tables& tables_;
  int step_px_ = 1;
  float box_px_ = 1;  ///< side of a sample in the plate
  Size samples_;
  std::vector<glm::vec2> plate_px_;  ///< of each sample's middle
  std::vector<Ray> rays_;            ///< of the places that are looked at
  Image<float> limit_w_;             ///< of each sample
  std::array<PeopleSamples, 2> seen_;
  ClusterMotion clusters_;
  Image<glm::vec2> motion_px_;
  bool known_ = false, any_ = false;
  int now_ = 0;
  double time_s_ = 0, interval_s_ = 0;
  geometry::Pose pose_;
};

}  // namespace mixrig::render

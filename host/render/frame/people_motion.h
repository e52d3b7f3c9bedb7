// SPDX-License-Identifier: Apache-2.0
// Motion of people in the view from one frame to the next. On the host, shared by both back ends.
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

/// A sparse picture of people: a sample is the mean of kMotionPoints^2 points of the plate.
struct PeopleSamples {
  Image<float> light;  ///< 0..255, not linear, with a margin of kMotionReach samples on all sides
  Image<float> w;      ///< inverse depth of the nearest person measured there, 1/m; 0: none
};
/// Largest motion, samples a frame along each axis, that is searched.
inline constexpr int kMotionReach = 8;
/// Samples along a cell's side; each cell has one motion.
inline constexpr int kMotionCell = 4;
inline constexpr int kMotionPoints = 4;

/// Motion between two sparse pictures. Cells of people connected in depth form a cluster. A
/// cluster's motion is the shift with the least sum of absolute differences; a cell's motion is
/// searched the same way within two samples of it, over 3x3 cells of the cluster. Used by one
/// compositor.
class ClusterMotion {
 public:
  explicit ClusterMotion(Size samples);
  Size cells() const { return cells_; }
  /// Motion of each cell in samples a frame from `before` to `now`, both of the constructor's size;
  /// 0 where nobody is. Cells within two cells of people move as these; of two people the one
  /// nearer to the camera counts. Allocates nothing.
  const Image<glm::vec2>& find(const PeopleSamples& now, const PeopleSamples& before);
  /// Whether a cell moved with people in the last find(): it is within two cells of them.
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
  Image<float> cell_w_;  ///< mean inverse depth of people, 1/m; 0: none
  Image<std::uint8_t> label_, spread_, next_spread_;
  Image<glm::vec2> motion_;
  std::vector<Place> cluster_;  ///< cells of the current cluster
  /// Cost of each shift of each cell; the last element is the number of samples.
  std::vector<std::array<float, kLocal * kLocal + 1>> costs_;
};

/// Steady matte (docs/method/compositor.md, "key, steady"): kBeforeShare is the share of the
/// previous matte where the plate has not changed. kAlike is the change of the root of light (of
/// 255, mean over channels and 3x3 pixels) at which the share falls to 1/e of it: some times a
/// sensor's noise.
inline constexpr float kBeforeShare = 0.7F;
inline constexpr float kAlike = 8;

/// Whether the key of this setup follows people: it needs a background that stands still.
bool follows_people(const CompositorSetup& setup);

/// Samples people and plate of each frame and estimates their motion since the frame before. Not
/// thread-safe.
class PeopleMotion {
 public:
  /// Reads plate_px, tof_ray and key_limit_w of `tables` now. Precondition: these hold for all
  /// frames.
  explicit PeopleMotion(const Tables& tables);
  /// Takes a frame; returns false for the last frame once more. Motion is known only if the camera
  /// stands where it stood in the frame before, and that is at most kPause_s ago. Allocates
  /// nothing.
  bool see(const FrameInput& input, Crew& crew);
  int cell_px() const { return kMotionCell * step_px_; }
  Size cells() const { return clusters_.cells(); }
  /// Motion of each cell since the frame before, view pixels; null: not known.
  const Image<glm::vec2>* motion_px() const { return known_ ? &motion_px_ : nullptr; }
  /// Whole pixels by which people's depth must be moved in each cell to fit the time of the plate.
  /// Returns false where nothing moves.
  bool depth_shift_px(double depth_delay_s, Image<glm::vec2>& shift) const;
  static constexpr double kPause_s = 0.25;

 private:
  void sample_light(ImageView<const Rgb8> plate, Crew& crew);
  void sample_light_row(ImageView<const Rgb8> plate, int y, float* light) const;
  void sample_people(ImageView<const float> tof_depth_m);

  /// A pixel of the ToF picture that is sampled.
  struct Ray {
    int x, y;
    /// A measured value times this is its point in metres, in axes of the ToF camera.
    glm::vec3 per_value;
  };

  const Tables& tables_;
  int step_px_ = 1;
  float box_px_ = 1;  ///< side of a sample in the plate, pixels
  Size samples_;
  std::vector<glm::vec2> plate_px_;  ///< plate pixel of each sample's centre
  std::vector<Ray> rays_;            ///< the ToF pixels that are sampled
  Image<float> limit_w_;             ///< limit of the key at each sample, 1/m
  std::array<PeopleSamples, 2> seen_;
  ClusterMotion clusters_;
  Image<glm::vec2> motion_px_;
  bool known_ = false, any_ = false;
  int now_ = 0;
  double time_s_ = 0, interval_s_ = 0;
  geometry::Pose pose_;
};

}  // namespace mixrig::render

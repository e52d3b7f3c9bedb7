// SPDX-License-Identifier: Apache-2.0
// Tracks points of the room through the pictures of a sequence.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "hal/base/image.h"
#include "host/math/geometry/any_camera.h"

namespace mixrig::reconstruction {

using Descriptor = std::array<std::uint8_t, 128>;  ///< SIFT (Lowe 2004)

/// An interest point of one picture.
struct Feature {
  Eigen::Vector2d px;
  float size_px = 0;
  Descriptor descriptor{};
};

/// Finds at most `most` SIFT features where the camera has rays, the strongest first.
std::vector<Feature> find_features(ImageView<const std::uint8_t> grey,
                                   const geometry::AnyCamera& camera, int most);

struct Sighting {
  int picture = 0;
  Eigen::Vector2d px;
  double sigma_px = 0;
};

/// Sightings of one point through the sequence.
struct FeatureTrack {
  std::vector<Sighting> seen;  ///< by picture, each at most once
};

/// A picture that differs enough from the one before to be worth solving for.
struct KeyPicture {
  int picture = 0;
  Image<std::uint8_t> grey;
  std::vector<Feature> features;
  std::vector<int> track_of_feature;  ///< -1: none
};

struct FeatureTracks {
  std::vector<double> times_s;  ///< of all pictures
  std::vector<FeatureTrack> tracks;
  std::vector<KeyPicture> keys;
  /// All pictures, smoothed for align_looks(); those after kMostKept_bytes are empty.
  std::vector<Image<std::uint8_t>> greys;
};

inline constexpr std::size_t kMostKept_bytes = 512U << 20U;

struct TrackingOptions {
  int tracks = 1500;      ///< points tracked at a time
  int features = 2500;    ///< SIFT features of a key picture
  double grey_sigma = 4;  ///< noise of a grey value, of 255
  /// A picture becomes a key where the tracks moved so far since the last key (median), or where 30
  /// % of them are lost.
  double key_step_rad = 0.05;
};

/// Tracks interest points (SIFT features and corners after Shi and Tomasi 1994) by KLT (Bouguet's
/// pyramid) from picture to picture, forward and back. Each point is aligned once more to the last
/// key picture, so that it does not drift between keys. At each key, lost tracks are searched for
/// again from the earlier key pictures. Not thread-safe.
class FeatureTracker {
 public:
  FeatureTracker(const geometry::AnyCamera& camera, const TrackingOptions& options);
  ~FeatureTracker();

  /// Adds pictures of the camera's size in order of time.
  void add(ImageView<const Rgb8> picture, double time_s);
  /// Returns the result and empties the tracker.
  FeatureTracks finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Luma (Rec. 601) of the sRGB values.
Image<std::uint8_t> grey_of(ImageView<const Rgb8> picture);

}  // namespace mixrig::reconstruction

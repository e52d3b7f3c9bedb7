// SPDX-License-Identifier: Apache-2.0
// The fisheye's pictures of a studio take, in the captures that they are fresh in. Private to this
// module.
#pragma once

#include <string>

#include "host/capture/capture/capture.h"
#include "studio/studio.h"

namespace mixrig::studio_io {

inline constexpr const char* kFisheyeTruth = "truth/fisheye.tum";
inline constexpr const char* kFisheyePeople = "truth/fisheye_people.csv";

/// Captures must come in the order of their frames. Not thread-safe.
class FisheyePictures {
 public:
  /// Renders the picture that belongs to `capture`, if there is one, and puts it there with its own
  /// stamp; else the capture has none. Nothing for a studio without a fisheye.
  void add_to(studio::Studio& studio, capture::Capture& capture);
  /// TUM lines "t x y z qx qy qz qw" of world_from_fisheye at the stamps of the pictures so far.
  const std::string& truth() const { return truth_; }
  /// CSV lines "picture,share": how much of the image circle people cover.
  const std::string& people() const { return people_; }

 private:
  studio::FisheyePicture next_;
  bool rendered_ = false;  ///< `next_` waits for its frame
  std::string truth_ = "# t x y z qx qy qz qw of world_from_fisheye at its own mid-exposure\n";
  std::string people_ = "picture,share\n";
};

}  // namespace mixrig::studio_io

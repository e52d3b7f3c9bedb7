// SPDX-License-Identifier: Apache-2.0
// Which pictures of the streams of a take make a frame. Private to this module.
#pragma once

#include <string>
#include <vector>

#include "hal/base/result.h"
#include "host/capture/take/take.h"
#include "host/capture/take/trajectory.h"

namespace mixrig::take {

/// Pictures of one frame: indices from 0, and the time of depth after that of colour.
struct PicturePair {
  int color = 0, depth = 0;
  double depth_after_s = 0;
  bool operator==(const PicturePair&) const = default;
};

/// Pairs numbered pictures of two streams. If both rates are given and differ, picture k of a
/// stream is of the time k / rate_hz (of depth, delay_s later), and each picture of the slower
/// stream gets the nearest one of the faster; else they pair by number. Sorted by colour. Pure.
std::vector<PicturePair> pair_numbered(const StreamInfo& color, const StreamInfo& depth,
                                       bool by_number);
/// Returns whether pair_numbered() pairs by time.
bool rates_differ(const StreamInfo& a, const StreamInfo& b);

/// Returns warnings about a list's times: steps that no camera makes, and times that run
/// backwards. `name` is the file. Pure.
std::vector<std::string> odd_stamps(const std::vector<StampedFile>& files, const std::string& name);

/// Makes the error of two lists without a pair within `most_s`: how far apart the nearest pictures
/// are, and which unit their times seem to have.
Error no_pairs(const std::vector<StampedFile>& color, const std::vector<StampedFile>& depth,
               const std::string& name, double most_s);

/// Makes the error of frames of which none has a pose of `poses` at its time.
Error no_poses(const std::vector<StampedPose>& poses, const std::vector<StampedFile>& color,
               const std::string& name);

}  // namespace mixrig::take

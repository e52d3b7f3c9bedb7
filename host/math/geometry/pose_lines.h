// SPDX-License-Identifier: Apache-2.0
// Text files of poses: TUM lines, and tables whose header names their columns.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "hal/base/result.h"

namespace mixrig::geometry {

/// A pose as its line has it: numbers may be not finite, the quaternion of any length.
struct PoseLine {
  int line = 0;       ///< in the file, from 1
  double time_s = 0;  ///< on the recorder's clock
  Eigen::Vector3d position_m;
  Eigen::Quaterniond rotation;
};

struct PoseLines {
  std::vector<PoseLine> poses;  ///< in the order of the file
  /// Unit that the times were taken in by their size; empty where they are seconds or the header
  /// says the unit.
  std::string guessed_unit;
};

/// Reads lines "t x y z qx qy qz qw", or the columns that a header names, in any order and among
/// others: time, position and quaternion, with units such as "[ns]" or "_ms". Blanks, commas or
/// semicolons part columns; '#' starts a comment, which may be the header. Pure.
/// Errors: kFormat (name:line: ...) for a header that lacks a column or has it twice, and for a
/// line with another number of columns.
Result<PoseLines> parse_pose_lines(std::string_view text, const std::string& name);

}  // namespace mixrig::geometry

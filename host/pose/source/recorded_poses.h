// SPDX-License-Identifier: Apache-2.0
// Poses of a recorded trajectory, found by time.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "hal/base/result.h"
#include "host/capture/capture/pose_source.h"
#include "host/pose/trajectory/trajectory.h"

namespace mixrig::pose {

struct RecordedOptions {
  std::string file;          ///< name of the trajectory, for messages
  double time_offset_s = 0;  ///< Capture::time_s = time of the trajectory + this
};

/// Poses of the target camera at any time of a recording; its rate and its clock's zero need not be
/// those of the captures. A capture's pose is interpolated (trajectory::Trajectory::at) at
/// Capture::time_s; outside the recording, in its gaps and across its jumps there is none.
class RecordedPoses final : public capture::PoseSource {
 public:
  /// Makes a source from `samples` in the order of the file. Samples that are not finite, and
  /// single ones far away from their neighbours, are left out and counted.
  /// Errors: kData if no sample is left, or if time runs backwards.
  static Result<std::unique_ptr<RecordedPoses>> make(
      const std::vector<trajectory::TimedPose>& samples, RecordedOptions options);
  /// Reads a trajectory file (trajectory::read_samples). Errors: those of the file, and of make().
  static Result<std::unique_ptr<RecordedPoses>> open(const std::filesystem::path& path,
                                                     RecordedOptions options);

  capture::CameraPose pose_of(const capture::Capture& capture) override;
  capture::PoseFaults faults() const override { return faults_; }
  /// Returns the first and last time of the recording, on the clock of Capture::time_s.
  std::pair<double, double> span_s() const;

 private:
  RecordedPoses(std::vector<trajectory::Trajectory> parts, capture::PoseFaults faults,
                const RecordedOptions& options);

  std::vector<trajectory::Trajectory> parts_;  ///< parts between jumps, in order of time
  capture::PoseFaults faults_;
  double time_offset_s_;
};

}  // namespace mixrig::pose

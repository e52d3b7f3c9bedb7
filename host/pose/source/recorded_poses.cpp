// SPDX-License-Identifier: Apache-2.0
#include "host/pose/source/recorded_poses.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "host/pose/source/motion_check.h"

namespace mixrig::pose {
namespace {

using capture::CameraPose;
using capture::PoseLoss;
using trajectory::TimedPose;
using trajectory::Trajectory;

/// Rounding of times in files: a frame at the very end of a trajectory has a pose.
constexpr double kRounding_s = 1e-6;

/// Returns the samples between jumps as parts. A part too short to be distinguished from a wrong
/// sample is left out, unless it is the only one.
std::vector<Trajectory> parts_of(const std::vector<TimedPose>& samples, MotionCheck& check) {
  std::vector<std::vector<TimedPose>> runs;
  for (const TimedPose& sample : samples) {
    switch (check.add(sample)) {
      case MotionCheck::Verdict::kTake:
        if (runs.empty()) runs.emplace_back();
        runs.back().push_back(sample);
        break;
      case MotionCheck::Verdict::kRestart:
        runs.emplace_back(check.run().begin(), check.run().end());
        break;
      case MotionCheck::Verdict::kRejected:
        break;
    }
  }
  std::vector<Trajectory> parts;
  for (auto& run : runs)
    if (run.size() >= MotionCheck::kRun || runs.size() == 1) parts.emplace_back(std::move(run));
  return parts;
}

/// Returns the time from `t_s` to the nearest sample.
double age_s(const Trajectory& part, double t_s) {
  const auto& samples = part.samples();
  const auto after = std::lower_bound(samples.begin(), samples.end(), t_s,
                                      [](const TimedPose& s, double t) { return s.t_s < t; });
  double age = after != samples.end() ? after->t_s - t_s : t_s - samples.back().t_s;
  if (after != samples.begin()) age = std::min(age, t_s - (after - 1)->t_s);
  return age;
}

/// Returns the times before and after the first place where time runs backwards.
std::optional<std::pair<double, double>> backward_step(const std::vector<TimedPose>& samples) {
  double last_s = -std::numeric_limits<double>::infinity();
  for (const TimedPose& sample : samples) {
    if (!std::isfinite(sample.t_s)) continue;
    if (sample.t_s < last_s) return std::pair(last_s, sample.t_s);
    last_s = sample.t_s;
  }
  return std::nullopt;
}

std::pair<double, double> span_of(const std::vector<Trajectory>& parts, double time_offset_s) {
  return {parts.front().start_s() + time_offset_s, parts.back().end_s() + time_offset_s};
}

std::string text_of(const std::vector<Trajectory>& parts, const RecordedOptions& options) {
  std::size_t count = 0;
  for (const Trajectory& part : parts) count += part.samples().size();
  const double step_s = parts.front().median_step_s();
  const auto [first_s, last_s] = span_of(parts, options.time_offset_s);
  return fmt::format(
      "recorded: {}, {} poses at {:.1f} Hz, from {:.3f} to {:.3f} s of the take; "
      "interpolated at mid-exposure",
      options.file, count, step_s > 0 ? 1 / step_s : 0.0, first_s, last_s);
}

}  // namespace

RecordedPoses::RecordedPoses(std::vector<Trajectory> parts, capture::PoseFaults faults,
                             const RecordedOptions& options)
    : PoseSource({"recorded", text_of(parts, options)}),
      parts_(std::move(parts)),
      faults_(faults),
      time_offset_s_(options.time_offset_s) {}

Result<std::unique_ptr<RecordedPoses>> RecordedPoses::make(const std::vector<TimedPose>& samples,
                                                           RecordedOptions options) {
  if (const auto step = backward_step(samples))
    return Error{ErrorCode::kData,
                 fmt::format("{}: time runs backwards from {:.6f} s to {:.6f} s: its clock was "
                             "set while it recorded, cut the file there",
                             options.file, step->first, step->second)};
  MotionCheck check;
  std::vector<Trajectory> parts = parts_of(samples, check);
  if (parts.empty())
    return Error{ErrorCode::kData, options.file +
                                       ": holds no pose: record the camera's trajectory "
                                       "again (lines t x y z qx qy qz qw)"};
  return std::unique_ptr<RecordedPoses>(
      new RecordedPoses(std::move(parts), check.faults(), options));
}

Result<std::unique_ptr<RecordedPoses>> RecordedPoses::open(const std::filesystem::path& path,
                                                           RecordedOptions options) {
  MIXRIG_ASSIGN(const std::vector<TimedPose> samples, trajectory::read_samples(path));
  return make(samples, std::move(options));
}

std::pair<double, double> RecordedPoses::span_s() const { return span_of(parts_, time_offset_s_); }

CameraPose RecordedPoses::pose_of(const capture::Capture& capture) {
  double t_s = capture.time_s - time_offset_s_;
  const auto part = std::find_if(parts_.begin(), parts_.end(), [=](const Trajectory& p) {
    return t_s <= p.end_s() + kRounding_s;
  });
  if (part != parts_.end() && t_s >= part->start_s() - kRounding_s)
    t_s = std::clamp(t_s, part->start_s(), part->end_s());
  if (part == parts_.end() || !(t_s >= parts_.front().start_s()))
    return CameraPose::lost(PoseLoss::kOutside);
  if (t_s < part->start_s()) return CameraPose::lost(PoseLoss::kJump);
  const auto known = part->at(t_s);
  if (!known) return CameraPose::lost(PoseLoss::kGap);
  CameraPose pose;
  pose.world_from_target = *known;
  pose.age_s = age_s(*part, t_s);
  return pose;
}

}  // namespace mixrig::pose

// SPDX-License-Identifier: Apache-2.0
// Sources of the target camera's pose: one pose for each capture, at its mid-exposure.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <Eigen/Core>

#include "host/capture/capture/capture.h"
#include "host/math/geometry/pose.h"

namespace mixrig::capture {

/// Why a capture has no pose.
enum class PoseLoss : std::uint8_t {
  kNone,       ///< the capture has a pose
  kAbsent,     ///< the source gives no pose
  kOutside,    ///< mid-exposure lies before the first or after the last sample
  kGap,        ///< the samples around it are too far apart
  kJump,       ///< the samples around it cannot be the motion of one camera
  kNotFinite,  ///< NaN or infinite
  kNoAngle,    ///< the angle of the head is not known
  kTooOld,     ///< the pose is older than the scene accepts
  kUntracked,  ///< the tracker does not recognise the room in the picture
  kNoPicture,  ///< the fisheye gives no picture
  kNoSample,   ///< the stream has sent no sample with a pose yet
  kCount
};
inline constexpr std::size_t kPoseLosses = static_cast<std::size_t>(PoseLoss::kCount);

/// "ok", "absent", "outside", "gap", "jump", "not_finite", "no_angle", "too_old",
/// "untracked", "no_picture", "no_sample".
std::string_view name(PoseLoss loss);

/// Covariance of (rotation vector rad, translation m), with R = exp(w) * R_estimate.
using PoseCovariance = Eigen::Matrix<double, 6, 6>;

/// The pose of one capture. Where it has none, `loss` says why and the other values mean nothing.
struct CameraPose {
  geometry::Pose world_from_target;
  std::optional<PoseCovariance> covariance;  ///< of world_from_target; absent: unknown
  double age_s = 0;                          ///< from the nearest sample used to mid-exposure, >= 0
  PoseLoss loss = PoseLoss::kNone;

  bool ok() const { return loss == PoseLoss::kNone; }
  static CameraPose lost(PoseLoss why) {
    CameraPose pose;
    pose.loss = why;
    return pose;
  }
};

/// Counts of the faults in a stream of poses.
struct PoseFaults {
  std::uint64_t not_finite = 0;   ///< samples that hold NaN, infinity, or no rotation
  std::uint64_t jumps = 0;        ///< places where the camera would move faster than a camera can
  std::uint64_t clock_steps = 0;  ///< times that the clock of the samples stepped
  std::uint64_t refused = 0;      ///< samples of a stream in which the camera is not tracked
  /// Datagrams of a network stream: missing ones, ones that came after a later one, damaged ones or
  /// ones of another protocol or layout, ones of another version, ones of another camera, source or
  /// sender, ones without the time stamp that the pose needs.
  std::uint64_t packets_lost = 0, packets_late = 0, packets_bad = 0, packets_version = 0,
                packets_foreign = 0, packets_unstamped = 0;

  std::uint64_t packets() const {
    return packets_lost + packets_late + packets_bad + packets_version + packets_foreign +
           packets_unstamped;
  }
};

/// State of a stream of poses from the network.
struct PoseStream {
  std::uint64_t packets = 0;  ///< received frames
  double delay_s = 0;         ///< configured: from the exposure of a frame to its earliest arrival
  double jitter_s = 0;        ///< sigma of the smallest delays about the fitted clock
  double drift_ppm = 0;       ///< drift of its clock against the host's
};

/// Whether two poses give different views: they are more than 10 mm or 0.004 rad apart.
bool moved(const geometry::Pose& a, const geometry::Pose& b);

/// Constant facts about a pose source.
struct PoseSourceInfo {
  std::string name;         ///< word of scene.toml, such as "recorded"
  std::string description;  ///< what it uses and needs, one line for display
  bool moves = true;        ///< false: every capture has the same pose
  /// Time that pose_of() must wait after a capture for later captures that its pose needs; 0 if it
  /// needs none.
  double latency_s = 0;
};

/// A source of poses. Calls come from one thread at a time, in the order of the captures.
class PoseSource {
 public:
  explicit PoseSource(PoseSourceInfo info) : info_(std::move(info)) {}
  virtual ~PoseSource() = default;
  const PoseSourceInfo& info() const { return info_; }
  /// Passes a capture, in order, whose pose will be asked for once the captures within
  /// info().latency_s after it were passed. Not needed if there is no latency.
  virtual void see(const Capture&) {}
  /// Returns the pose at the capture's mid-exposure. It never allocates, blocks or fails:
  /// CameraPose::loss says why there is no pose.
  virtual CameraPose pose_of(const Capture& capture) = 0;
  /// Counts since the source was made.
  virtual PoseFaults faults() const { return {}; }
  /// Returns the state of the network stream, if the poses come from one.
  virtual std::optional<PoseStream> stream() const { return std::nullopt; }

 private:
  const PoseSourceInfo info_;
};

}  // namespace mixrig::capture

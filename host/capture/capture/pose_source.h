// SPDX-License-Identifier: Apache-2.0
// Where the pose of the target camera comes from: one pose for each capture, at its mid-exposure.
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
  kNone,       ///< it has one
  kAbsent,     ///< its source gives none
  kOutside,    ///< mid-exposure lies before the first or after the last sample
  kGap,        ///< the samples around it are too far apart
  kJump,       ///< the samples around it are no motion of one camera
  kNotFinite,  ///< NaN or infinite
  kNoAngle,    ///< the angle of the head is not known
  kTooOld,     ///< older than the scene accepts
  kUntracked,  ///< the tracker does not recognise the room in the picture
  kNoPicture,  ///< the fisheye gives no picture
  kCount
};
inline constexpr std::size_t kPoseLosses = static_cast<std::size_t>(PoseLoss::kCount);

/// "ok", "absent", "outside", "gap", "jump", "not_finite", "no_angle", "too_old",
/// "untracked", "no_picture".
std::string_view name(PoseLoss loss);

/// Of (rotation vector rad, translation m): R = exp(w) * R_estimate.
using PoseCovariance = Eigen::Matrix<double, 6, 6>;

/// The pose of one capture. Where it has none, `loss` says why and the other values mean nothing.
struct CameraPose {
  geometry::Pose world_from_target;
  std::optional<PoseCovariance> covariance;  ///< of world_from_target, where it is known
  double age_s = 0;                          ///< from the nearest sample used to mid-exposure, >= 0
  PoseLoss loss = PoseLoss::kNone;

  bool ok() const { return loss == PoseLoss::kNone; }
  static CameraPose lost(PoseLoss why) {
    CameraPose pose;
    pose.loss = why;
    return pose;
  }
};

/// What a stream of poses contained that is no pose, as counts.
struct PoseFaults {
  std::uint64_t not_finite = 0;   ///< samples that hold NaN, infinity, or no rotation
  std::uint64_t jumps = 0;        ///< places where the camera would move faster than one can
  std::uint64_t clock_steps = 0;  ///< times that the clock of the samples stepped
  std::uint64_t refused = 0;      ///< frames of a motion capture without the camera's body
  std::uint64_t packets_lost = 0, packets_late = 0, packets_bad = 0;  ///< of a network stream
};

/// A stream of poses from the network.
struct PoseStream {
  std::uint64_t packets = 0;  ///< frames that came
  double delay_s = 0;         ///< as given: from the exposure of a frame to its earliest arrival
  double jitter_s = 0;        ///< sigma of the least delays about the fitted clock
  double drift_ppm = 0;       ///< of its clock to the host's
};

/// Whether a camera at two poses sees two views: they are more than 10 mm or 0.004 rad apart.
bool moved(const geometry::Pose& a, const geometry::Pose& b);

/// What does not change of a pose source.
struct PoseSourceInfo {
  std::string name;         ///< as in scene.toml: "recorded"
  std::string description;  ///< what it uses and needs, one line for people
  bool moves = true;        ///< false: every capture has the same pose
  /// How long pose_of() must wait after a capture for those that tell its pose: 0 where its own
  /// and those before do.
  double latency_s = 0;
};

/// Calls come from one thread at a time, in the order of the captures.
class PoseSource {
 public:
  explicit PoseSource(PoseSourceInfo info) : info_(std::move(info)) {}
  virtual ~PoseSource() = default;
  const PoseSourceInfo& info() const { return info_; }
  /// A capture whose pose will be asked for, after those that come within info().latency_s of it;
  /// in their order. Not needed where there is no latency.
  virtual void see(const Capture&) {}
  /// Pose at the capture's mid-exposure. Does not allocate, block or fail: CameraPose::loss.
  virtual CameraPose pose_of(const Capture& capture) = 0;
  /// Counts since the source was made.
  virtual PoseFaults faults() const { return {}; }
  /// What is known of the network stream that the poses come from, if they do.
  virtual std::optional<PoseStream> stream() const { return std::nullopt; }

 private:
  const PoseSourceInfo info_;
};

}  // namespace mixrig::capture

// SPDX-License-Identifier: Apache-2.0
// The decoded streams of a rig at one tick. Rig, take and studio all make captures; code that uses
// a Capture does not depend on its source.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>

#include "hal/base/clock.h"
#include "hal/base/image.h"
#include "hal/device/pan_tilt.h"
#include "host/capture/capture/camera_picture.h"
#include "host/capture/capture/rig_cameras.h"
#include "host/math/geometry/lens_table.h"

namespace mixrig::capture {

enum class Stream : std::uint8_t { kPlate, kDepth, kDepth2, kFisheye, kPanTilt, kCount };
enum class StreamStatus : std::uint8_t {
  kAbsent,    ///< the source has no such stream
  kFresh,     ///< recorded at this tick
  kRepeated,  ///< the last value again: the stream is slower than the plate
  kMissing,   ///< expected at this tick, but not received
};
/// Origin of world_from_target.
enum class PoseOrigin : std::uint8_t {
  kUnknown,   ///< no pose: the identity
  kRecorded,  ///< the frame's own, from the take or the studio
  kFixed,     ///< one pose for all frames: rig.toml or the recording that is played
};

/// Origin of a frame's lens.
enum class LensOrigin : std::uint8_t {
  kFixed,    ///< the cameras' lens, for all frames
  kEncoded,  ///< from the encoder values at mid-exposure
  kClamped,  ///< encoder values outside the calibrated table: its border
  kHeld,     ///< no encoder value near mid-exposure: the last lens is kept
};
inline constexpr std::size_t kLensOrigins = 4;

/// The target camera's lens in force.
struct FrameLens {
  geometry::LensState state;
  LensOrigin origin = LensOrigin::kFixed;
};

std::string_view name(StreamStatus status);
std::string_view name(LensOrigin origin);
std::string_view name(PoseOrigin origin);

/// Measurement of a second depth camera.
struct DepthPicture {
  Image<float> depth_m;     ///< along the axis or the ray (DepthKind); 0 = unknown
  Image<float> amplitude;   ///< empty if the source has none
  HostTime mid_exposure{};  ///< on the clock of Capture::mid_exposure
};

/// One capture: plate, depth and other streams at one tick, with cameras and pose. Its buffers are
/// kept when it is read into again. Images of streams that are not kFresh or kRepeated are empty.
struct Capture {
  int number = 0;           ///< 1-based, counts the captures of a source
  std::uint64_t tick = 0;   ///< tick of the 100 Hz master; 0 if the source has none
  HostTime mid_exposure{};  ///< the plate's, on the source's clock
  double time_s = 0;        ///< the plate's, since the source's start or its own epoch
  Image<Rgb8> plate;        ///< sRGB, distorted, size of cameras->target; empty where
                            ///< CaptureSource::share_plates() left it: see plate_of()
  /// The plate in its camera's buffer, which stays reserved while this is held; null if the plate
  /// was copied.
  std::shared_ptr<const CameraPicture> picture;
  Image<float> depth_m;           ///< size of cameras->tof; by DepthKind; 0 = unknown
  Image<float> amplitude;         ///< size of depth_m; empty if the source has none
  HostTime depth_mid_exposure{};  ///< depth_m's, on the clock of mid_exposure; 0: unknown
  /// From cameras->tof2; its images are empty in frames without it.
  DepthPicture depth2;
  Image<Rgb8> fisheye;                ///< sRGB, distorted; has its own rate, see its status
  HostTime fisheye_mid_exposure{};    ///< fisheye's, on the clock of mid_exposure; 0: no picture
  std::uint64_t fisheye_counter = 0;  ///< its camera's counter; 0: no picture
  std::optional<device::PanTiltAngles> pan_tilt;   ///< at mid-exposure
  std::optional<geometry::LensEncoders> encoders;  ///< of the target's lens, at mid-exposure
  std::shared_ptr<const RigCameras> cameras;       ///< intrinsics in force; `lens` overrides them
  /// Replaces the lens of cameras->target if the lens is calibrated by its encoders.
  /// world_from_target stays the pose of the camera's frame, from which the pupil's shift is
  /// measured.
  std::optional<FrameLens> lens;
  geometry::Pose world_from_target;
  PoseOrigin pose_origin = PoseOrigin::kUnknown;
  std::array<StreamStatus, static_cast<std::size_t>(Stream::kCount)> status{};

  StreamStatus status_of(Stream stream) const { return status[static_cast<std::size_t>(stream)]; }
  void set_status(Stream stream, StreamStatus s) { status[static_cast<std::size_t>(stream)] = s; }
  /// Called by Pool when the last user drops the capture: returns the camera's buffer.
  void recycle() { picture.reset(); }
};

/// Returns the plate, and decodes it first if necessary. Any thread.
inline const Image<Rgb8>& plate_of(const Capture& capture) {
  return capture.plate.empty() && capture.picture ? capture.picture->decoded() : capture.plate;
}

/// Dropping the last reference returns the buffers to their pool.
using CapturePtr = std::shared_ptr<const Capture>;

}  // namespace mixrig::capture

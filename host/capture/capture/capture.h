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
  kFresh,     ///< of this tick
  kRepeated,  ///< the last value again: the stream is slower than the plate
  kMissing,   ///< expected at this tick, but not received
};
/// Where world_from_target comes from.
enum class PoseOrigin : std::uint8_t {
  kUnknown,   ///< none: the identity
  kRecorded,  ///< of this frame, from the take or the studio
  kFixed,     ///< one pose for all frames: rig.toml or the recording that is played
};

/// Where the lens of a frame comes from.
enum class LensOrigin : std::uint8_t {
  kFixed,    ///< that of the cameras, for all frames
  kEncoded,  ///< what the encoders said at mid-exposure
  kClamped,  ///< the same, outside the calibrated table: its border
  kHeld,     ///< no value of the encoders near mid-exposure: the last lens again
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

/// What a second depth camera measured.
struct DepthPicture {
  Image<float> depth_m;     ///< as DepthKind; 0 = unknown
  Image<float> amplitude;   ///< empty where the source has none
  HostTime mid_exposure{};  ///< on the clock of Capture::mid_exposure
};

/// Buffers are kept when a Capture is read into again. Images of streams that are not kFresh or
/// kRepeated are empty.
struct Capture {
  int number = 0;                     ///< 1-based, counts the captures of a source
  std::uint64_t tick = 0;             ///< of the 100 Hz master; 0 where the source has none
  HostTime mid_exposure{};            ///< of the plate, on the source's clock
  double time_s = 0;                  ///< of the plate, since the source's start or its own epoch
  Image<Rgb8> plate;                  ///< sRGB, distorted, size of cameras->target; empty where
                                      ///< CaptureSource::share_plates() left it: see plate_of()
  /// The plate in its camera's buffer, which is kept for it; null where it was copied.
  std::shared_ptr<const CameraPicture> picture;
  Image<float> depth_m;               ///< size of cameras->tof, as DepthKind; 0 = unknown
  Image<float> amplitude;             ///< as depth_m; empty where the source has none
  HostTime depth_mid_exposure{};      ///< of `depth_m`, on the clock of mid_exposure; 0: not known
  DepthPicture depth2;                ///< of cameras->tof2; its images are empty in frames without
  Image<Rgb8> fisheye;                ///< sRGB, distorted; at its own rate, its status says of when
  HostTime fisheye_mid_exposure{};    ///< of `fisheye`, on the clock of mid_exposure; 0: no picture
  std::uint64_t fisheye_counter = 0;  ///< of `fisheye`: its camera's own; 0: no picture
  std::optional<device::PanTiltAngles> pan_tilt;   ///< at mid-exposure
  std::optional<geometry::LensEncoders> encoders;  ///< of the target camera's lens, the same
  std::shared_ptr<const RigCameras> cameras;       ///< intrinsics in force, but for `lens`
  /// In place of cameras->target, where the lens is calibrated by its encoders. world_from_target
  /// stays that of the camera's frame, which the pupil's shift is measured from.
  std::optional<FrameLens> lens;
  geometry::Pose world_from_target;
  PoseOrigin pose_origin = PoseOrigin::kUnknown;
  std::array<StreamStatus, static_cast<std::size_t>(Stream::kCount)> status{};

  StreamStatus status_of(Stream stream) const { return status[static_cast<std::size_t>(stream)]; }
  void set_status(Stream stream, StreamStatus s) { status[static_cast<std::size_t>(stream)] = s; }
  /// In a Pool: a capture that nobody looks at keeps no buffer of a camera.
  void recycle() { picture.reset(); }
};

/// The plate: decoded now where it is not yet. Any thread.
inline const Image<Rgb8>& plate_of(const Capture& capture) {
  return capture.plate.empty() && capture.picture ? capture.picture->decoded() : capture.plate;
}

/// Dropping the last reference returns the buffers to their pool.
using CapturePtr = std::shared_ptr<const Capture>;

}  // namespace mixrig::capture

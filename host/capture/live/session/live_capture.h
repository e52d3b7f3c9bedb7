// SPDX-License-Identifier: Apache-2.0
// Decodes a frame set of the live rig into a Capture.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>

#include "hal/base/pool.h"
#include "host/capture/capture/capture.h"
#include "host/capture/capture/capture_source.h"
#include "host/capture/capture/decode.h"
#include "host/capture/live/rig/devices.h"
#include "host/capture/live/session/live_session.h"
#include "host/capture/take/take.h"

namespace mixrig::live {

/// Returns the cameras of a live rig: those of rig.toml, else of the played recording, else those
/// that the devices report, else a pinhole of 60 degrees, which `mixrig calibrate` replaces.
/// Errors: kUsage for a rig without a camera or without a depth camera, or with a fisheye whose
/// rate is not known.
Result<take::TakeInfo> take_info(const RigConfig& config, const Devices& devices);

/// Returns the meaning of the depth camera's steps: as the device reports it, overridden by
/// rig.toml. Precondition: the rig has a depth camera.
device::DepthInfo depth_info(const RigConfig& config, const Devices& devices);
/// Returns the meaning of a colour camera's samples: as the device reports it, overridden by
/// rig.toml.
capture::ColorSettings color_settings(const CameraConfig& config, const device::CameraInfo& info);

/// Returns the index of the camera named kFisheye in `config.cameras`; 0 if the rig has none.
std::size_t fisheye_index(const RigConfig& config);
/// Returns the fisheye's rate: that of its trigger, else the device's, else the requested one; 0 if
/// none is known or there is no fisheye.
double fisheye_rate_hz(const RigConfig& config, const Devices& devices);

/// What happens to a set with colour and without depth.
enum class WithoutDepth {
  kSkip,  ///< it is not decoded
  kHold,  ///< once depth has come: has the last depth again (kRepeated) for kDepthHold after its
          ///< exposure, then none (kMissing)
};
/// How long the last depth is repeated. People who run move 20 cm in this time.
inline constexpr Duration kDepthHold = std::chrono::milliseconds(100);

/// Decodes frame sets. Not thread-safe.
class SetDecoder {
 public:
  /// `config` and `devices` must outlive it.
  SetDecoder(const RigConfig& config, const Devices& devices,
             WithoutDepth without_depth = WithoutDepth::kSkip);
  /// Decodes plate, depth in metres, amplitude and, if the rig has a camera named "fisheye", its
  /// picture with its own mid-exposure and counter (capture::fisheye_status; a picture that cannot
  /// be decoded is missing); sets mid-exposure, tick, head angles and the streams' status. Keeps
  /// the buffers of `capture`, and does not change its number, time, cameras and pose. Errors:
  /// kData if the set lacks colour or (except with kHold) depth, or one of them cannot be decoded:
  /// skip it.
  Result<void> decode(const LiveSet& set, capture::Capture& capture);
  /// Sets the forms of the plates of the next sets. Any thread.
  void share_plates(capture::PlateForms forms) { forms_ = forms; }

 private:
  Result<void> decode_plate(const device::FramePtr& frame, capture::Capture& capture);
  Result<void> decode_depth(const LiveSet& set, capture::Capture& capture);
  void decode_fisheye(const LiveSet& set, capture::Capture& capture);
  void decode_second_depth(const LiveSet& set, capture::Capture& capture);

  const Devices& devices_;
  const device::DepthInfo depth_, depth2_;  ///< default if the rig has no such camera
  capture::ColorDecoder plate_, fisheye_decoder_;
  std::atomic<capture::PlateForms> forms_{};
  Pool<capture::CameraPicture> pictures_;
  const std::size_t fisheye_;  ///< index of the fisheye's stream; 0 if the rig has none
  const Duration fisheye_hold_;
  const WithoutDepth without_depth_;
  sync::TimedFrame held_depth_;  ///< the last depth frame, for kHold
  std::optional<std::uint64_t> last_depth_, last_depth2_,
      last_fisheye_;  ///< counters of the last decoded frames
};

/// Sets the pose of the target camera and its origin: from rig.toml, else from the played recording
/// by the plate's counter, else unknown.
void set_pose(const RigConfig& config, const Devices& devices, const LiveSet& set,
              capture::Capture& capture);

}  // namespace mixrig::live

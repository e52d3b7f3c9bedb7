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

/// The cameras of a live rig: those of rig.toml, else of the recording that is played, else what
/// the devices report, else a pinhole of 60 degrees, which `mixrig calibrate` replaces.
/// Errors: kUsage for a rig without a camera or without a depth camera, or with a fisheye whose
/// rate is not known.
Result<take::TakeInfo> take_info(const RigConfig& config, const Devices& devices);

/// What the steps of the depth camera mean: as the device tells it, but for what rig.toml says.
/// Precondition: the rig has a depth camera.
device::DepthInfo depth_info(const RigConfig& config, const Devices& devices);
/// What the samples of a colour camera mean, likewise.
capture::ColorSettings color_settings(const CameraConfig& config, const device::CameraInfo& info);

/// Index of the further camera named kFisheye in `config.cameras`; 0 where the rig has none.
std::size_t fisheye_index(const RigConfig& config);
/// Its trigger's, else the device's, else the wanted one; 0 where none is known or there is none.
double fisheye_rate_hz(const RigConfig& config, const Devices& devices);

/// A set with colour and without depth.
enum class WithoutDepth {
  kSkip,  ///< is not decoded
  kHold,  ///< once depth has come: has the last depth again (kRepeated) for kDepthHold after its
          ///< exposure, then none (kMissing)
};
/// People move 20 cm in it when they run.
inline constexpr Duration kDepthHold = std::chrono::milliseconds(100);

/// Decodes frame sets. Not thread-safe.
class SetDecoder {
 public:
  /// `config` and `devices` must outlive it.
  SetDecoder(const RigConfig& config, const Devices& devices,
             WithoutDepth without_depth = WithoutDepth::kSkip);
  /// Plate, depth in metres, amplitude and, where the rig has a camera named "fisheye", its
  /// picture with its own mid-exposure and counter (capture::fisheye_status; one that cannot be
  /// decoded is missing); mid-exposure, tick, head angles and the streams' status. Keeps the
  /// buffers of `capture`, and does not change its number, time, cameras and pose. Errors: kData
  /// where the set lacks colour or depth, but for kHold, or one of them cannot be decoded: skip it.
  Result<void> decode(const LiveSet& set, capture::Capture& capture);
  /// Forms of the plates of the next sets. Any thread.
  void share_plates(capture::PlateForms forms) { forms_ = forms; }

 private:
  Result<void> decode_plate(const device::FramePtr& frame, capture::Capture& capture);
  Result<void> decode_depth(const LiveSet& set, capture::Capture& capture);
  void decode_fisheye(const LiveSet& set, capture::Capture& capture);
  void decode_second_depth(const LiveSet& set, capture::Capture& capture);

  const Devices& devices_;
  const device::DepthInfo depth_, depth2_;  ///< default where the rig has no such camera
  capture::ColorDecoder plate_, fisheye_decoder_;
  std::atomic<capture::PlateForms> forms_{};
  Pool<capture::CameraPicture> pictures_;
  const std::size_t fisheye_;  ///< index of its stream; 0 where the rig has none
  const Duration fisheye_hold_;
  const WithoutDepth without_depth_;
  sync::TimedFrame held_depth_;                             ///< the last one, of kHold
  std::optional<std::uint64_t> last_depth_, last_depth2_,
      last_fisheye_;  ///< counters of the last decoded frames
};

/// Sets the pose of the target camera and its origin: from rig.toml, else from the played recording
/// by the plate's counter, else unknown.
void set_pose(const RigConfig& config, const Devices& devices, const LiveSet& set,
              capture::Capture& capture);

}  // namespace mixrig::live

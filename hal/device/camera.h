// SPDX-License-Identifier: Apache-2.0
// Cameras: description, controls, delivery of frames, and health.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "hal/device/frame.h"

namespace mixrig::device {

/// Which clock Frame::device_time was read from.
enum class StampClock {
  kNone,    ///< no stamp: only `received` is valid
  kHost,    ///< CLOCK_MONOTONIC of this host: device_time is a HostTime
  kDevice,  ///< the device's own oscillator: host/capture/sync maps it
};

/// Matrix that converts YUV to R'G'B'. JPEG files are always full-range BT.601.
enum class YuvMatrix { kBt601, kBt709, kBt2020 };
enum class SampleRange {
  kUsual,    ///< YUV limited, everything else full
  kLimited,  ///< 8-bit black is 16, white 235, chroma 16 to 240
  kFull,
};
/// Converts R'G'B', grey and Bayer samples to linear light.
enum class Transfer {
  kSrgb,    ///< IEC 61966-2-1
  kBt709,   ///< ITU-R BT.709, from picture to scene light
  kLinear,  ///< samples are linear light, as in most machine-vision cameras
  kGamma,   ///< light = sample ^ gamma
};
/// Meaning of a camera's samples. Primaries are those of sRGB.
struct ColorEncoding {
  YuvMatrix matrix = YuvMatrix::kBt601;
  SampleRange range = SampleRange::kUsual;
  Transfer transfer = Transfer::kSrgb;
  double gamma = 2.2;  ///< used by kGamma only
  bool operator==(const ColorEncoding&) const = default;
};

/// Requested stream settings; zeros and kUnknown keep the device's present ones.
struct StreamRequest {
  Size size{};
  PixelFormat format = PixelFormat::kUnknown;
  double rate_hz = 0;
  bool hardware_trigger = false;  ///< one frame per trigger edge, where the device supports it
  std::string trigger_input{};  ///< the device's name of that input; empty: the driver's usual one
  /// Frames may lie in the device's own buffers if the driver shares these (Frame::memory). Nothing
  /// is copied then, but the processor may read them slowly. While consumers hold so many that the
  /// device would have too few left, frames are copies.
  bool lends = false;
};

enum class CameraControl {
  kExposure,      ///< seconds; setting it turns automatic exposure off
  kGain,          ///< the device's own unit
  kFocus,         ///< the device's own unit; setting it turns autofocus off
  kWhiteBalance,  ///< kelvin; setting it turns automatic white balance off
  kZoom,          ///< the device's own unit
};
inline constexpr int kCameraControls = 5;
std::string_view name(CameraControl control);

struct ControlRange {
  CameraControl control = CameraControl::kExposure;
  double minimum = 0, maximum = 0, step = 0;
};

struct CameraInfo {
  std::string uri{}, model{}, serial{};
  Size size{};
  PixelFormat format = PixelFormat::kUnknown;
  double rate_hz = 0;  ///< nominal, 0 where unknown or triggered
  StampClock stamp_clock = StampClock::kNone;
  bool hardware_trigger = false;  ///< exposes on trigger edges
  std::vector<ControlRange> controls{};
  ColorEncoding color{};                          ///< as the device reports it
  std::uint16_t usb_vendor = 0, usb_product = 0;  ///< 0: not a USB device, or unknown
  std::string
      ptp{};  ///< PTP state of the camera's clock when it was opened, or "off"; empty: no PTP
  bool mirrored = false;  ///< its pictures are mirrored left to right
  int sample_bits = 8;    ///< of grey and Bayer samples, before scaling to 16 bit
};

/// Present state of a device.
enum class DeviceState {
  kStopped,
  kStreaming,
  kLost,    ///< unplugged or failed; the driver tries to reopen it
  kFailed,  ///< the driver gave up: see the last error of start()
};
std::string_view name(DeviceState state);

/// Counts since construction; they never decrease.
struct StreamHealth {
  DeviceState state = DeviceState::kStopped;
  std::uint64_t frames = 0;       ///< published
  std::uint64_t lost = 0;         ///< missing according to the device's counter
  std::uint64_t incomplete = 0;   ///< published with kFrameIncomplete
  std::uint64_t overrun = 0;      ///< dropped because every buffer was in use
  std::uint64_t link_errors = 0;  ///< malformed packets, failed transfers
  std::uint64_t returns = 0;      ///< times the device was lost and found again
};

/// A camera. Call its methods from one thread, except health(), which any thread may call, and
/// set() and get(), which another thread may call between start() and stop().
class Camera {
 public:
  virtual ~Camera() = default;
  virtual const CameraInfo& info() const = 0;
  /// Delivers frames to `sink` on the driver's thread until stop(). Errors: kDevice, kUsage when
  /// it runs already.
  virtual Result<void> start(FrameSink sink) = 0;
  /// Returns after the last call to the sink. Does nothing when stopped.
  virtual void stop() = 0;
  /// Errors: kUnsupported, kUsage outside the range, kDevice.
  virtual Result<void> set(CameraControl control, double value) = 0;
  virtual Result<double> get(CameraControl control) = 0;
  virtual StreamHealth health() const = 0;
};

}  // namespace mixrig::device

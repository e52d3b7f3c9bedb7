// SPDX-License-Identifier: Apache-2.0
// Driver of the Kinect v2 over libusb: `kinect2:SERIAL`, a depth camera and a colour camera in one
// device.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "extras/kinect2/kinect2_protocol.h"
#include "extras/kinect2/usb_streams.h"
#include "hal/base/clock.h"
#include "hal/device/depth_camera.h"

namespace mixrig::device {

/// Converts raw frames to depth steps; implemented with host/capture/depth. For one thread.
class RawDepthDecoder {
 public:
  virtual ~RawDepthDecoder() = default;
  virtual const DepthInfo& depth() const = 0;
  /// `pictures`: kKinect2RawBytes; the others: a 16-bit value, little-endian, for each pixel. Must
  /// not allocate.
  virtual void decode(std::span<const std::uint8_t> pictures, std::span<std::uint8_t> steps,
                      std::span<std::uint8_t> amplitude, std::span<std::uint8_t> confidence) = 0;
};
using MakeRawDepthDecoder =
    std::function<std::unique_ptr<RawDepthDecoder>(const Kinect2Infrared&, const Kinect2Offsets&)>;

/// The device behind the two cameras. One thread serves both streams while either runs; starting or
/// stopping a camera does not disturb the other one. After it was unplugged the driver looks for it
/// four times a second; after a second without data it is started again.
class Kinect2;
/// Opens the device and reads serial number, lenses and phase offsets. `make` is called once.
/// Errors: those of the pipes; kDevice for answers that are not valid.
Result<std::shared_ptr<Kinect2>> open_kinect2(std::unique_ptr<UsbStreams> usb, std::string uri,
                                              Clock& clock, const MakeRawDepthDecoder& make);
/// Depth camera of a device: frames of 512x424 with amplitude and confidence.
std::unique_ptr<DepthCamera> kinect2_depth_camera(std::shared_ptr<Kinect2> device);
/// Colour camera of a device: JPEG files of 1920x1080, mirrored as CameraInfo says. The device
/// controls the exposure.
std::unique_ptr<Camera> kinect2_color_camera(std::shared_ptr<Kinect2> device);

}  // namespace mixrig::device

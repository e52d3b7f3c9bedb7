// SPDX-License-Identifier: Apache-2.0
#include "extras/kinect2/kinect2_driver.h"

#include <memory>
#include <string_view>
#include <utility>

#include "extras/kinect2/kinect2_camera.h"
#include "extras/kinect2/kinect2_depth.h"
#include "extras/kinect2/libusb_streams.h"
#include "hal/base/log.h"

namespace mixrig::device {
namespace {

class Kinect2Driver final : public live::DeviceDriver {
 public:
  explicit Kinect2Driver(Clock& clock) : clock_(clock) {}
  Result<std::unique_ptr<Camera>> camera(const std::string& address,
                                         const StreamRequest& /*request*/) override {
    const auto slash = address.rfind('/');
    if (address.substr(slash == std::string::npos ? 0 : slash + 1) != "color")
      return Error{ErrorCode::kUsage,
                   "'kinect2:" + address + "' is not a camera: use kinect2:SERIAL/color"};
    MIXRIG_ASSIGN(auto kinect, open(slash == std::string::npos ? "" : address.substr(0, slash)));
    return kinect2_color_camera(std::move(kinect));
  }
  Result<std::unique_ptr<DepthCamera>> depth(const std::string& address,
                                             const StreamRequest& /*request*/) override {
    MIXRIG_ASSIGN(auto kinect, open(address));
    return kinect2_depth_camera(std::move(kinect));
  }
  std::vector<live::FoundCamera> find() override {
    const std::vector<std::string> serials = list_kinect2();
    for (const std::string& serial : serials)
      if (serial.empty())
        log_warning("rig", "a Kinect v2 may not be opened: install the udev rules (board/udev)");
    return kinects_of(serials);
  }

 private:
  /// Opens a device once, for both of its cameras.
  Result<std::shared_ptr<Kinect2>> open(const std::string& serial) {
    for (const auto& [name, kinect] : kinects_)
      if (name == serial) return kinect;
    MIXRIG_ASSIGN(auto usb, make_libusb_kinect2(serial));
    MIXRIG_ASSIGN(auto kinect,
                  open_kinect2(std::move(usb), "kinect2:" + serial, clock_, make_kinect2_decoder));
    kinects_.emplace_back(serial, kinect);
    return kinect;
  }

  Clock& clock_;
  std::vector<std::pair<std::string, std::shared_ptr<Kinect2>>> kinects_;
};

std::unique_ptr<live::DeviceDriver> make_kinect2_driver(Clock& clock) {
  return std::make_unique<Kinect2Driver>(clock);
}

}  // namespace

live::DeviceKind kinect2_kind() {
  return {.scheme = "kinect2",
          .extra = "kinect2",
          .camera_uri = "kinect2:SERIAL/color",
          .depth_uri = "kinect2:SERIAL",
          .lens_uri = {},
          .make = make_kinect2_driver,
          .lens = {}};
}

std::vector<live::FoundCamera> kinects_of(const std::vector<std::string>& serials) {
  std::vector<live::FoundCamera> found;
  for (const std::string& serial : serials) {
    if (serial.empty() && serials.size() > 1) continue;
    const std::string uri = "kinect2:" + serial;
    CameraInfo color, depth;
    color.format = PixelFormat::kMjpeg;
    depth.format = PixelFormat::kDepth16;
    found.push_back({uri + "/color", color});
    found.push_back({uri, depth});
  }
  return found;
}

}  // namespace mixrig::device

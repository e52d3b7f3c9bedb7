// SPDX-License-Identifier: Apache-2.0
#include "extras/openni2/openni2_driver.h"

#include <utility>

#include "extras/openni2/openni2_camera.h"

namespace mixrig::device {
namespace {

class OpenNi2Driver final : public live::DeviceDriver {
 public:
  explicit OpenNi2Driver(Clock& clock) : clock_(clock) {}
  Result<std::unique_ptr<Camera>> camera(const std::string& address,
                                         const StreamRequest& request) override {
    MIXRIG_ASSIGN(auto shared, open(address));
    return openni2_color(std::move(shared), request);
  }
  Result<std::unique_ptr<DepthCamera>> depth(const std::string& address,
                                             const StreamRequest& request) override {
    MIXRIG_ASSIGN(auto shared, open(address));
    return openni2_depth(std::move(shared), request);
  }
  std::vector<live::FoundCamera> find() override {
    std::vector<live::FoundCamera> found;
    for (const std::string& address : list_openni2()) {
      const std::string uri = "openni2:" + address;
      if (const auto color = camera(address, {})) found.push_back({uri, (*color)->info()});
      if (const auto steps = depth(address, {})) found.push_back({uri, (*steps)->info()});
    }
    return found;
  }

 private:
  /// Opens a device once, for both of its cameras.
  Result<std::shared_ptr<OpenNi2Device>> open(const std::string& address) {
    for (const auto& [name, device] : devices_)
      if (name == address) return device;
    MIXRIG_ASSIGN(auto device, open_openni2(address, clock_));
    devices_.emplace_back(address, device);
    return device;
  }

  Clock& clock_;
  std::vector<std::pair<std::string, std::shared_ptr<OpenNi2Device>>> devices_;
};

std::unique_ptr<live::DeviceDriver> make_openni2_driver(Clock& clock) {
  return std::make_unique<OpenNi2Driver>(clock);
}

}  // namespace

live::DeviceKind openni2_kind() {
  return {.scheme = "openni2",
          .extra = "openni2",
          .camera_uri = "openni2:URI",
          .depth_uri = "openni2:URI",
          .lens_uri = {},
          .make = make_openni2_driver,
          .lens = {}};
}

}  // namespace mixrig::device

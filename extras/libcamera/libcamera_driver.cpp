// SPDX-License-Identifier: Apache-2.0
#include "extras/libcamera/libcamera_driver.h"

#include <cctype>
#include <string_view>
#include <utility>

#include "extras/libcamera/libcamera_camera.h"

namespace mixrig::device {
namespace {

/// libcamera's ids of UVC cameras end with vendor and product: "...-1:1.0-046d:0825".
bool is_webcam(std::string_view libcamera_id) {
  constexpr std::size_t kTail = 10;
  if (libcamera_id.size() < kTail) return false;
  const std::string_view tail = libcamera_id.substr(libcamera_id.size() - kTail);
  for (std::size_t i = 0; i < kTail; ++i) {
    const bool mark = i == 0 || i == 5;
    const bool fits = mark ? tail[i] == (i == 0 ? '-' : ':')
                           : std::isxdigit(static_cast<unsigned char>(tail[i])) != 0;
    if (!fits) return false;
  }
  return true;
}

class LibcameraDriver final : public live::DeviceDriver {
 public:
  explicit LibcameraDriver(Clock& clock) : clock_(clock) {}
  Result<std::unique_ptr<Camera>> camera(const std::string& address,
                                         const StreamRequest& request) override {
    return open_libcamera(address, request, clock_);
  }
  Result<std::unique_ptr<DepthCamera>> depth(const std::string& address,
                                             const StreamRequest& /*request*/) override {
    return Error{ErrorCode::kUsage, "'libcamera:" + address + "' is not a depth camera"};
  }
  std::vector<live::FoundCamera> find() override {
    std::vector<live::FoundCamera> found;
    for (const std::string& id : without_webcams(list_libcamera()))
      if (const auto opened = camera(id, {}))
        found.push_back({"libcamera:" + id, (*opened)->info(), /*processed=*/true});
    return found;
  }

 private:
  Clock& clock_;
};

std::unique_ptr<live::DeviceDriver> make_libcamera_driver(Clock& clock) {
  return std::make_unique<LibcameraDriver>(clock);
}

}  // namespace

live::DeviceKind libcamera_kind() {
  return {.scheme = "libcamera",
          .extra = "libcamera",
          .camera_uri = "libcamera:ID",
          .depth_uri = {},
          .lens_uri = {},
          .make = make_libcamera_driver,
          .lens = {}};
}

std::vector<std::string> without_webcams(std::vector<std::string> ids) {
  std::erase_if(ids, [](const std::string& id) { return is_webcam(id); });
  return ids;
}

}  // namespace mixrig::device

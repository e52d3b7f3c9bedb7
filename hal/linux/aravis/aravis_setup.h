// SPDX-License-Identifier: Apache-2.0
// Set-up of a GenICam camera through libaravis: format, size, trigger, 3D. Private to this module.
#pragma once

#include <cstdint>
#include <string>

#include "hal/base/result.h"
#include "hal/device/camera.h"
#include "hal/device/depth_camera.h"
#include "hal/wire/camera/genicam_buffer.h"

typedef struct _ArvCamera ArvCamera;  // NOLINT(modernize-use-using): as libaravis declares it
typedef struct _GError GError;        // NOLINT(modernize-use-using)

namespace mixrig::device {

/// A GError for one call; frees itself.
class AravisFault {
 public:
  AravisFault() = default;
  AravisFault(const AravisFault&) = delete;
  AravisFault& operator=(const AravisFault&) = delete;
  ~AravisFault() { clear(); }
  operator GError**() {  // NOLINT(google-explicit-constructor)
    clear();
    return &error_;
  }
  bool any() const { return error_ != nullptr; }
  std::string text() const;
  /// Returns a kDevice error with the line "URI: WHAT: reason".
  Error error(const std::string& uri, const std::string& what) const {
    return Error{ErrorCode::kDevice, uri + ": " + what + ": " + text()};
  }

 private:
  void clear();
  GError* error_ = nullptr;
};

/// Stops an acquisition that a crashed client left running and sets the requested format and size;
/// fills size and format of `info`. Returns the camera's pixel format code.
/// Errors: kUnsupported, kDevice.
Result<std::uint32_t> choose_aravis_format(ArvCamera* camera, const StreamRequest& request,
                                           CameraInfo& info);
/// Does what choose_aravis_format() does, for depth: switches the components on and takes the first
/// Coord3D format that the camera accepts. Errors: kUnsupported, kDevice.
Result<std::uint32_t> choose_aravis_depth(ArvCamera* camera, const StreamRequest& request,
                                          CameraInfo& info);
/// Sets the trigger's input line, or free running at the requested rate; fills rate and trigger of
/// `info`. Errors: kDevice.
Result<void> choose_aravis_trigger(ArvCamera* camera, const StreamRequest& request,
                                   CameraInfo& info);
/// Fills model, serial number, controls and PTP state of `info`.
void describe_aravis(ArvCamera* camera, CameraInfo& info);
/// Meaning of depth steps, and how floats become steps.
struct AravisDepth {
  DepthInfo steps;
  FloatDepth floats;
};
/// Reads scale, offset, invalid value and intrinsics for pictures of format `code` (SFNC 2.7, 3D
/// Scan Control). Errors: kDevice where the camera reports no scale, kUnsupported where the format
/// is not depth.
Result<AravisDepth> aravis_depth_info(ArvCamera* camera, const std::string& uri,
                                      std::uint32_t code);

}  // namespace mixrig::device

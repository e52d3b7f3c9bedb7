// SPDX-License-Identifier: Apache-2.0
// Driver for cameras whose pictures the kernel does not process, through libcamera: `libcamera:ID`.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "hal/base/clock.h"
#include "hal/device/camera.h"

namespace mixrig::device {

/// Opens a camera. `id`: as `cam -l` lists it; "any": the only camera. Chooses the format and size
/// that fit the request best among those offered for video, as for a V4L2 node (choose_mode).
/// Exposure (seconds) and gain can be set where the camera has them. Time stamps are those of the
/// kernel's buffers. When the camera disappears, the driver looks for it four times a second.
/// Errors: kNotFound, with the existing ids, kUnsupported, kDevice.
Result<std::unique_ptr<Camera>> open_libcamera(const std::string& id, const StreamRequest& request,
                                               Clock& clock);

/// Ids of the cameras of this machine. Must not be called while another thread has a camera open.
std::vector<std::string> list_libcamera();

}  // namespace mixrig::device

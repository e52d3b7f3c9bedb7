// SPDX-License-Identifier: Apache-2.0
// Cameras that the kernel gives no finished pictures of, through libcamera: `libcamera:ID`.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "hal/base/clock.h"
#include "hal/device/camera.h"

namespace mixrig::device {

/// `id` as `cam -l` lists it; "any": the only camera there is. Of the formats and sizes that the
/// camera offers for video that which fits the request best is taken, as of a V4L2 node
/// (choose_mode). Exposure (seconds) and gain can be set where the camera has them. Stamps are
/// those of the kernel's buffers. When the camera disappears, the driver looks for it four times a
/// second. Errors: kNotFound, with the ids that there are, kUnsupported, kDevice.
Result<std::unique_ptr<Camera>> open_libcamera(const std::string& id, const StreamRequest& request,
                                               Clock& clock);

/// Ids of the cameras of this machine. Not while a camera is open in another thread.
std::vector<std::string> list_libcamera();

}  // namespace mixrig::device

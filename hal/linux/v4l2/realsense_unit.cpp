// SPDX-License-Identifier: Apache-2.0
#include "hal/linux/v4l2/realsense_unit.h"

#include <cerrno>

#include <fcntl.h>
#include <linux/usb/video.h>
#include <linux/uvcvideo.h>
#include <unistd.h>

#include "hal/linux/v4l2/v4l2_ioctl.h"
#include "hal/wire/camera/realsense_table.h"

namespace mixrig::device {
namespace {

/// Transfers one message; returns 0 or the errno.
int transfer(int node, std::uint8_t query, RealSenseMessage& message) {
  uvc_xu_control_query request{};
  request.unit = kRealSenseUnit;
  request.selector = kRealSenseMonitor;
  request.query = query;
  request.size = static_cast<std::uint16_t>(message.size());
  request.data = message.data();
  return ioctl_again(node, UVCIOC_CTRL_QUERY, &request) < 0 ? errno : 0;
}

}  // namespace

Result<DeviceIntrinsics> realsense_intrinsics(const std::string& node, Size size) {
  const std::string what = "v4l2:" + node + ": asking for the factory calibration";
  const int fd = ::open(node.c_str(), O_RDWR | O_CLOEXEC);
  if (fd < 0) return system_error(ErrorCode::kDevice, what, errno);
  RealSenseMessage message = realsense_calibration_request();
  int failed = transfer(fd, UVC_SET_CUR, message);
  if (failed == 0) failed = transfer(fd, UVC_GET_CUR, message);
  ::close(fd);
  if (failed != 0) return system_error(ErrorCode::kDevice, what, failed);
  return parse_realsense_calibration(message, size);
}

}  // namespace mixrig::device

// SPDX-License-Identifier: Apache-2.0
#include "extras/libcamera/libcamera_parts.h"

#include <mutex>

#include <libcamera/logging.h>

#include "extras/libcamera/libcamera_format.h"

namespace mixrig::device {

Result<std::shared_ptr<lc::CameraManager>> libcamera_manager() {
  static std::mutex mutex;
  static std::weak_ptr<lc::CameraManager> known;
  const std::lock_guard lock(mutex);
  if (auto manager = known.lock()) return manager;
  lc::logSetTarget(lc::LoggingTargetSyslog);  // it reports each start and camera
  auto manager = std::make_shared<lc::CameraManager>();
  if (const int code = manager->start(); code != 0)
    return system_error(ErrorCode::kIo, "libcamera does not start", -code);
  known = manager;
  return manager;
}

ColorEncoding libcamera_encoding(const std::optional<lc::ColorSpace>& space) {
  ColorEncoding color;
  if (!space) return color;
  using Yuv = lc::ColorSpace::YcbcrEncoding;
  using Curve = lc::ColorSpace::TransferFunction;
  if (space->ycbcrEncoding == Yuv::Rec709) color.matrix = YuvMatrix::kBt709;
  if (space->ycbcrEncoding == Yuv::Rec2020) color.matrix = YuvMatrix::kBt2020;
  if (space->transferFunction == Curve::Rec709) color.transfer = Transfer::kBt709;
  if (space->transferFunction == Curve::Linear) color.transfer = Transfer::kLinear;
  if (space->ycbcrEncoding != Yuv::None)
    color.range =
        space->range == lc::ColorSpace::Range::Full ? SampleRange::kFull : SampleRange::kLimited;
  return color;
}

std::vector<V4l2Mode> libcamera_modes(const lc::StreamFormats& formats, bool any_size) {
  std::vector<V4l2Mode> modes;
  const auto size = [](const lc::Size& s) {
    return Size{static_cast<int>(s.width), static_cast<int>(s.height)};
  };
  for (const lc::PixelFormat& format : formats.pixelformats()) {
    const std::uint32_t code = v4l2_of_drm(format.fourcc(), format.modifier(), 1);
    if (code == 0) continue;
    for (const lc::Size& s : formats.sizes(format)) modes.push_back({code, size(s), size(s)});
    const lc::SizeRange range = formats.range(format);
    if (range.min != range.max && any_size)
      modes.push_back({code, size(range.min), size(range.max)});
  }
  return modes;
}

}  // namespace mixrig::device

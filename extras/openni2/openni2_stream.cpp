// SPDX-License-Identifier: Apache-2.0
#include "extras/openni2/openni2_stream.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

namespace mixrig::device {
namespace {

constexpr double kRateWithin_hz = 0.5;

PixelFormat format_of(OniPixelFormat format) {
  switch (format) {
    case ONI_PIXEL_FORMAT_DEPTH_1_MM:
    case ONI_PIXEL_FORMAT_DEPTH_100_UM:
      return PixelFormat::kDepth16;
    case ONI_PIXEL_FORMAT_RGB888:
      return PixelFormat::kRgb8;
    case ONI_PIXEL_FORMAT_YUYV:
      return PixelFormat::kYuyv;
    case ONI_PIXEL_FORMAT_GRAY8:
      return PixelFormat::kGray8;
    case ONI_PIXEL_FORMAT_GRAY16:
      return PixelFormat::kGray16;
    default:
      return PixelFormat::kUnknown;
  }
}

template <typename T>
std::optional<T> property(OniStreamHandle stream, int id) {
  T value{};
  int bytes = sizeof value;
  if (oniStreamGetProperty(stream, id, &value, &bytes) != ONI_STATUS_OK) return std::nullopt;
  return value;
}

std::string text_of(const OniVideoMode& mode) {
  return fmt::format("{} {}x{} at {} Hz", name(format_of(mode.pixelFormat)), mode.resolutionX,
                     mode.resolutionY, mode.fps);
}

bool fits(const OniVideoMode& mode, const StreamRequest& request) {
  const PixelFormat format = format_of(mode.pixelFormat);
  if (format == PixelFormat::kUnknown || mode.resolutionX <= 0 || mode.resolutionY <= 0)
    return false;
  const bool size =
      request.size.empty() || request.size == Size{mode.resolutionX, mode.resolutionY};
  const bool rate = request.rate_hz <= 0 || std::abs(mode.fps - request.rate_hz) < kRateWithin_hz;
  return size && rate && (request.format == PixelFormat::kUnknown || request.format == format);
}

/// Number of values of a mode that equal those of the present mode.
int likeness(const OniVideoMode& mode, const OniVideoMode& present) {
  return (mode.pixelFormat == present.pixelFormat ? 1 : 0) + (mode.fps == present.fps ? 1 : 0) +
         (mode.resolutionX == present.resolutionX ? 1 : 0);
}

Result<OniVideoMode> choose_mode(OniStreamHandle stream, const OniVideoMode& present,
                                 const StreamRequest& request, const std::string& uri) {
  if (fits(present, request)) return present;
  const OniSensorInfo* sensor = oniStreamGetSensorInfo(stream);
  const std::span<const OniVideoMode> modes(
      sensor->pSupportedVideoModes, static_cast<std::size_t>(sensor->numSupportedVideoModes));
  const OniVideoMode* best = nullptr;
  std::string offered;
  for (const OniVideoMode& mode : modes) {
    if (fits(mode, {})) offered += (offered.empty() ? "" : ", ") + text_of(mode);
    if (!fits(mode, request)) continue;
    if (best == nullptr || likeness(mode, present) > likeness(*best, present)) best = &mode;
  }
  if (best != nullptr) return *best;
  return Error{ErrorCode::kUnsupported, uri + ": does not offer the requested mode: it offers " +
                                            (offered.empty() ? "none that mixrig reads" : offered)};
}

/// Copies a row of pixels of `bytes` each from right to left.
void copy_turned(const std::uint8_t* row, int width, std::size_t bytes, std::uint8_t* out) {
  for (int x = width - 1; x >= 0; --x, out += bytes)
    std::memcpy(out, row + static_cast<std::size_t>(x) * bytes, bytes);
}

}  // namespace

Error openni2_error(const std::string& uri, const std::string& what) {
  std::string reason = oniGetExtendedError();
  std::replace(reason.begin(), reason.end(), '\n', ' ');
  while (!reason.empty() && (reason.back() == ' ' || reason.back() == '\t')) reason.pop_back();
  return Error{ErrorCode::kDevice,
               uri + ": " + what + ": " + (reason.empty() ? "OpenNI2 gives no reason" : reason)};
}

Result<OpenNi2Mode> set_up_openni2(OniStreamHandle stream, const StreamRequest& request,
                                   const std::string& uri) {
  const auto present = property<OniVideoMode>(stream, ONI_STREAM_PROPERTY_VIDEO_MODE);
  if (!present) return openni2_error(uri, "reading the video mode");
  MIXRIG_ASSIGN(const OniVideoMode mode, choose_mode(stream, *present, request, uri));
  if (std::memcmp(&mode, &*present, sizeof mode) != 0 &&
      oniStreamSetProperty(stream, ONI_STREAM_PROPERTY_VIDEO_MODE, &mode, sizeof mode) !=
          ONI_STATUS_OK)
    return openni2_error(uri, "setting the video mode");
  OpenNi2Mode out{.mode = mode, .format = format_of(mode.pixelFormat)};
  const OniBool off = FALSE;
  if (oniStreamIsPropertySupported(stream, ONI_STREAM_PROPERTY_MIRRORING))
    (void)oniStreamSetProperty(stream, ONI_STREAM_PROPERTY_MIRRORING, &off, sizeof off);
  // For a recording, mirroring can be read, but neither queried as supported nor set.
  out.mirrored = property<OniBool>(stream, ONI_STREAM_PROPERTY_MIRRORING).value_or(FALSE) != FALSE;
  if (out.mirrored && out.format == PixelFormat::kYuyv)
    return Error{ErrorCode::kUnsupported,
                 uri + ": is mirrored YUYV: record it as RGB, or without mirroring"};
  return out;
}

DepthInfo openni2_depth_info(OniStreamHandle stream, const OniVideoMode& mode) {
  DepthInfo info{.metres_per_step =
                     mode.pixelFormat == ONI_PIXEL_FORMAT_DEPTH_100_UM ? 0.0001 : 0.001};
  const auto angle = property<float>(stream, ONI_STREAM_PROPERTY_HORIZONTAL_FOV);
  if (!angle || !(*angle > 0.0F && *angle < 3.0F)) return info;
  const double half_px = 0.5 * mode.resolutionX;
  info.intrinsics =
      DeviceIntrinsics{.focal_px = half_px / std::tan(0.5 * static_cast<double>(*angle)),
                       .principal_x_px = half_px,
                       .principal_y_px = 0.5 * mode.resolutionY};
  return info;
}

bool copy_openni2(const OniFrame& frame, const OpenNi2Mode& mode, std::span<std::uint8_t> out) {
  const std::size_t row = row_bytes(mode.format, mode.mode.resolutionX);
  const auto rows = static_cast<std::size_t>(mode.mode.resolutionY);
  if (frame.data == nullptr || frame.croppingEnabled || frame.dataSize < 0 || frame.stride < 0 ||
      frame.width != mode.mode.resolutionX || frame.height != mode.mode.resolutionY ||
      frame.videoMode.pixelFormat != mode.mode.pixelFormat)
    return false;
  const auto stride = static_cast<std::size_t>(frame.stride);
  if (stride < row || out.size() < row * rows ||
      static_cast<std::size_t>(frame.dataSize) < stride * (rows - 1) + row)
    return false;
  const auto* from = static_cast<const std::uint8_t*>(frame.data);
  const std::size_t pixel = row / static_cast<std::size_t>(frame.width);
  for (std::size_t y = 0; y < rows; ++y) {
    if (mode.mirrored)
      copy_turned(from + y * stride, frame.width, pixel, out.data() + y * row);
    else
      std::memcpy(out.data() + y * row, from + y * stride, row);
  }
  return true;
}

}  // namespace mixrig::device

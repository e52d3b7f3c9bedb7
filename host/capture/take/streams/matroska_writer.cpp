// SPDX-License-Identifier: Apache-2.0
// Writing of Matroska streams.
#include <chrono>
#include <cmath>
#include <thread>

#include <gst/app/gstappsrc.h>

#include "host/capture/take/streams/matroska.h"

namespace mixrig::take {

namespace {

/// Waits as long as frames are being taken: a busy machine may need longer for them than wait_for()
/// waits.
void wait_while_taken(GstElement* source, const Pipeline& pipeline) {
  constexpr auto kMostStill = std::chrono::seconds(10);
  guint64 left = gst_app_src_get_current_level_bytes(GST_APP_SRC(source));
  auto since = std::chrono::steady_clock::now();
  while (left > 0 && !pipeline.has_failed()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    const auto now = std::chrono::steady_clock::now();
    const guint64 level = gst_app_src_get_current_level_bytes(GST_APP_SRC(source));
    if (level != left) since = now;
    if (now - since > kMostStill) return;
    left = level;
  }
}

}  // namespace

const char* raw_format(PixelKind kind) {
  // FFV1's RGB is stored by a reversible transform; of the 8-bit channel orders
  // GStreamer's encoder accepts this one.
  return kind == PixelKind::kRgb8 ? "BGRx" : "GRAY16_LE";
}

Result<MatroskaWriter> MatroskaWriter::create(const std::filesystem::path& path, PixelKind kind,
                                              Size size, double rate_hz) {
  const int rate_milli_hz = static_cast<int>(std::lround(rate_hz * 1000.0));
  // Every frame is a key frame, so that readers can seek.
  const std::string description =
      std::string(
          "appsrc name=source format=time block=true max-bytes=33554432 caps=video/x-raw,format=") +
      raw_format(kind) + ",width=" + std::to_string(size.width) +
      ",height=" + std::to_string(size.height) + ",framerate=" + std::to_string(rate_milli_hz) +
      "/1000 ! avenc_ffv1 gop-size=1 ! matroskamux ! filesink name=file";
  MIXRIG_ASSIGN(Pipeline pipeline, Pipeline::create(description, path));
  GstElementPtr source(pipeline.element("source"));
  MIXRIG_TRY(pipeline.play());
  return MatroskaWriter(std::move(pipeline), std::move(source), size, rate_hz, path.string());
}

template <typename T, typename Fill>
Result<void> MatroskaWriter::push(ImageView<const T> image, std::size_t bytes_per_pixel,
                                  Fill fill_row) {
  if (image.size != size_)
    return Error{ErrorCode::kData, "cannot write '" + name_ + "': frame " +
                                       std::to_string(frames_ + 1) +
                                       " has another size than the first"};
  // GStreamer pads raw rows to four bytes.
  const std::size_t stride = (static_cast<std::size_t>(size_.width) * bytes_per_pixel + 3) / 4 * 4;
  const std::size_t bytes = stride * static_cast<std::size_t>(size_.height);
  auto* data = static_cast<guint8*>(g_malloc0(bytes));
  for (int y = 0; y < size_.height; ++y)
    fill_row(image.row(y), data + static_cast<std::size_t>(y) * stride);
  GstBuffer* buffer = gst_buffer_new_wrapped(data, bytes);
  GST_BUFFER_PTS(buffer) = static_cast<GstClockTime>(std::llround(frames_ / rate_hz_ * GST_SECOND));
  GST_BUFFER_DURATION(buffer) = static_cast<GstClockTime>(std::llround(GST_SECOND / rate_hz_));
  ++frames_;
  const GstFlowReturn taken = gst_app_src_push_buffer(GST_APP_SRC(source_.get()), buffer);
  if (taken == GST_FLOW_OK) return {};
  const std::string what = "cannot write '" + name_ + "'";
  Error error = pipeline_.error(ErrorCode::kIo, what);
  if (error.context == what)  // it posted no reason
    error.context += ": GStreamer takes no more frames (" + std::string(gst_flow_get_name(taken)) +
                     "): check the disk's free space";
  return error;
}

Result<void> MatroskaWriter::write(ImageView<const Rgb8> image) {
  return push(image, 4, [this](const Rgb8* from, guint8* to) {
    for (int x = 0; x < size_.width; ++x, to += 4)
      to[0] = from[x].b, to[1] = from[x].g, to[2] = from[x].r;
  });
}

Result<void> MatroskaWriter::write(ImageView<const std::uint16_t> image) {
  return push(image, 2, [this](const std::uint16_t* from, guint8* to) {
    for (int x = 0; x < size_.width; ++x, to += 2) {
      to[0] = static_cast<guint8>(from[x] & 255U);
      to[1] = static_cast<guint8>(from[x] >> 8);
    }
  });
}

Result<void> MatroskaWriter::finish() {
  wait_while_taken(source_.get(), pipeline_);
  gst_app_src_end_of_stream(GST_APP_SRC(source_.get()));
  return pipeline_.wait_for(GST_MESSAGE_EOS, "write");
}

}  // namespace mixrig::take

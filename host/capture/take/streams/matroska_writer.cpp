// SPDX-License-Identifier: Apache-2.0
// Writing of Matroska streams.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include <gst/app/gstappsrc.h>

#include "host/capture/take/streams/matroska.h"

namespace mixrig::take {

namespace {

constexpr guint64 kMostWaitingBytes = guint64{32} << 20;
/// Waits until at most `most` bytes wait for the encoder: a busy machine may need longer for them
/// than wait_for() waits. False if the pipeline has failed, or takes nothing for ten seconds; it
/// never blocks in the pipeline itself.
bool wait_while_taken(GstElement* source, const Pipeline& pipeline, guint64 most) {
  constexpr auto kMostStill = std::chrono::seconds(10);
  guint64 left = gst_app_src_get_current_level_bytes(GST_APP_SRC(source));
  auto since = std::chrono::steady_clock::now();
  while (left > most) {
    if (pipeline.has_failed()) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    const auto now = std::chrono::steady_clock::now();
    const guint64 level = gst_app_src_get_current_level_bytes(GST_APP_SRC(source));
    if (level != left) since = now;
    if (now - since > kMostStill) return false;
    left = level;
  }
  return !pipeline.has_failed();
}

constexpr const char* kFailed = "mixrig-failed";

/// Writes nothing to the file after the first error. The muxer would go on: it ends the stream, and
/// its index behind the frame that failed would be read as that frame.
void write_nothing_after_an_error(const Pipeline& pipeline) {
  const GstElementPtr file(pipeline.element("file"));
  GstPad* const pad = gst_element_get_static_pad(file.get(), "sink");
  constexpr int kData = GST_PAD_PROBE_TYPE_BUFFER | GST_PAD_PROBE_TYPE_BUFFER_LIST;
  const auto drop = +[](GstPad* sink, GstPadProbeInfo*, gpointer) {
    return g_object_get_data(G_OBJECT(sink), kFailed) != nullptr ? GST_PAD_PROBE_DROP
                                                                 : GST_PAD_PROBE_OK;
  };
  gst_pad_add_probe(pad, static_cast<GstPadProbeType>(kData), drop, nullptr, nullptr);
  // Called by the thread of the error, before it goes on. The bus keeps the pad.
  const auto note = +[](GstBus*, GstMessage* message, gpointer sink) {
    if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR)
      g_object_set_data(G_OBJECT(sink), kFailed, sink);
    return GST_BUS_PASS;
  };
  GstBus* const bus = gst_element_get_bus(pipeline.get());
  gst_bus_set_sync_handler(bus, note, pad, gst_object_unref);
  gst_object_unref(bus);
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
  // Every frame is a key frame, so that readers can seek. The muxer keeps its index, 32 bytes an
  // entry, in memory until the end: it has every eighth frame, from which readers decode on. What
  // the encoder gives is in the file at once: a recording that is cut off has it.
  constexpr double kFramesPerEntry = 8;
  const auto index_every_ns = std::llround(kFramesPerEntry / rate_hz * 1e9);
  const std::string description =
      std::string(
          "appsrc name=source format=time block=false max-bytes=0 caps=video/x-raw,format=") +
      raw_format(kind) + ",width=" + std::to_string(size.width) +
      ",height=" + std::to_string(size.height) + ",framerate=" + std::to_string(rate_milli_hz) +
      "/1000 ! avenc_ffv1 gop-size=1 ! matroskamux min-cluster-duration=500000000 "
      "max-cluster-duration=1000000000 min-index-interval=" +
      std::to_string(index_every_ns) + " ! filesink name=file buffer-mode=unbuffered";
  MIXRIG_ASSIGN(Pipeline pipeline, Pipeline::create(description, path));
  write_nothing_after_an_error(pipeline);
  GstElementPtr source(pipeline.element("source"));
  MIXRIG_TRY(pipeline.play());
  return MatroskaWriter(std::move(pipeline), std::move(source), size, rate_hz, path.string());
}

/// Number of frames that were pushed within half a second: only those may wait for the encoder, so
/// that a process that is killed loses no more, however slow the machine is. At least one may.
std::uint64_t MatroskaWriter::young_frames() {
  constexpr auto kMostWaiting = std::chrono::milliseconds(500);
  const auto oldest = std::chrono::steady_clock::now() - kMostWaiting;
  while (!pushed_.empty() && pushed_.front() < oldest) pushed_.pop_front();
  return std::max<std::uint64_t>(pushed_.size(), 1);
}

template <typename T, typename Fill>
Result<void> MatroskaWriter::push(ImageView<const T> image, std::size_t bytes_per_pixel,
                                  Fill fill_row) {
  if (image.size != size_)
    return Error{ErrorCode::kData, "cannot write '" + name_ + "': frame " +
                                       std::to_string(frames_ + 1) +
                                       " has another size than the first"};
  if (failed_) return *failed_;
  // GStreamer pads raw rows to four bytes.
  const std::size_t stride = (static_cast<std::size_t>(size_.width) * bytes_per_pixel + 3) / 4 * 4;
  const std::size_t bytes = stride * static_cast<std::size_t>(size_.height);
  if (!wait_while_taken(source_.get(), pipeline_,
                        std::min(kMostWaitingBytes, young_frames() * bytes)))
    return refused("the disk or the machine is too slow");
  auto* data = static_cast<guint8*>(g_malloc0(bytes));
  for (int y = 0; y < size_.height; ++y)
    fill_row(image.row(y), data + static_cast<std::size_t>(y) * stride);
  GstBuffer* buffer = gst_buffer_new_wrapped(data, bytes);
  GST_BUFFER_PTS(buffer) = static_cast<GstClockTime>(std::llround(frames_ / rate_hz_ * GST_SECOND));
  GST_BUFFER_DURATION(buffer) = static_cast<GstClockTime>(std::llround(GST_SECOND / rate_hz_));
  ++frames_;
  pushed_.push_back(std::chrono::steady_clock::now());
  const GstFlowReturn taken = gst_app_src_push_buffer(GST_APP_SRC(source_.get()), buffer);
  return taken == GST_FLOW_OK ? Result<void>() : refused(gst_flow_get_name(taken));
}

/// The pipeline's own reason, or `otherwise` if it gives none.
Error MatroskaWriter::refused(const std::string& otherwise) {
  const std::string what = "cannot write '" + name_ + "'";
  Error error = pipeline_.error(ErrorCode::kIo, what);
  if (error.context == what)
    error.context +=
        ": GStreamer takes no more frames (" + otherwise + "): check the disk's free space";
  failed_ = error;
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
  if (failed_) return *failed_;
  (void)wait_while_taken(source_.get(), pipeline_, 0);
  gst_app_src_end_of_stream(GST_APP_SRC(source_.get()));
  return pipeline_.wait_for(GST_MESSAGE_EOS, "write");
}

}  // namespace mixrig::take

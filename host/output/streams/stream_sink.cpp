// SPDX-License-Identifier: Apache-2.0
#include "host/output/streams/stream_sink.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include <gst/app/gstappsrc.h>
#include <gst/video/video.h>

#include "hal/base/log.h"
#include "host/capture/take/streams/gst_pipeline.h"
#include "host/output/streams/i420.h"
#include "host/output/streams/stream_host.h"
#include "host/output/streams/timing_message.h"

namespace mixrig::output {
namespace {

constexpr guint64 kQueued = 2;  // pictures that wait for GStreamer
constexpr Duration kCallEvery = std::chrono::seconds(2);

std::vector<take::GstNeed> needs_of(const StreamPlan& plan) {
  std::vector<take::GstNeed> needs;
  for (const StreamNeed& need : plan.needs) needs.push_back({need.element, need.package});
  return needs;
}

/// Returns the first of NAME.mkv, NAME-2.mkv, NAME-3.mkv and so on that holds nothing: a run that
/// is started again must not replace its show.
std::string free_file(const std::string& wanted) {
  namespace fs = std::filesystem;
  const fs::path path(wanted);
  fs::path free = path;
  std::error_code error;
  for (int i = 2; fs::is_regular_file(free, error) && fs::file_size(free, error) > 0; ++i)
    free.replace_filename(path.stem().string() + "-" + std::to_string(i) +
                          path.extension().string());
  return free.string();
}

/// Plans the stream with its receiver's numeric address. Errors: kUsage.
Result<StreamPlan> plan_with_host(const scene::StreamOut& out, Size view, double rate_hz) {
  MIXRIG_ASSIGN(StreamPlan plan, plan_stream(out, view, rate_hz));
  if (plan.host.empty()) return plan;
  const auto host = numeric_host(plan.host);
  if (!host)
    return Error{host.error().code, "stream_out \"" + out.uri + "\": " + host.error().context};
  for (auto& [key, value] : plan.texts)
    if (key == "host") value = *host;
  return plan;
}

/// Mends the messages of each buffer that leaves an element.
GstPadProbeReturn mend_messages(GstPad*, GstPadProbeInfo* info, gpointer) {
  GstBuffer* const buffer = gst_buffer_make_writable(GST_PAD_PROBE_INFO_BUFFER(info));
  GST_PAD_PROBE_INFO_DATA(info) = buffer;
  GstMapInfo map;
  if (gst_buffer_map(buffer, &map, GST_MAP_READWRITE) == 0) return GST_PAD_PROBE_OK;
  const std::size_t all = map.size, size = end_messages({map.data, map.size});
  gst_buffer_unmap(buffer, &map);
  if (size < all) gst_buffer_set_size(buffer, static_cast<gssize>(size));
  return GST_PAD_PROBE_OK;
}

void mend_messages_of(const take::GstElementPtr& parse) {
  GstPad* const pad = gst_element_get_static_pad(parse.get(), "src");
  gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, mend_messages, nullptr, nullptr);
  gst_object_unref(pad);
}

/// Waits up to a second for pictures that are on their way; a receiver that takes nothing must not
/// delay the run.
void wait_shortly(GstElement* pipeline) {
  GstBus* const bus = gst_element_get_bus(pipeline);
  const auto wanted = static_cast<GstMessageType>(GST_MESSAGE_ERROR | GST_MESSAGE_EOS);
  GstMessage* const message = gst_bus_timed_pop_filtered(bus, GST_SECOND, wanted);
  if (message != nullptr) gst_message_unref(message);
  gst_object_unref(bus);
}

}  // namespace

struct StreamSink::Graph {
  take::Pipeline pipeline;
  take::GstElementPtr source;
  bool waits = false, i420 = false, calls = false;
};

StreamSink::StreamSink(const scene::StreamOut& out, Size view, double rate_hz, bool transparent,
                       RoomBehind behind)
    : out_(out), view_(view), rate_hz_(rate_hz), picture_(out, transparent, std::move(behind)) {
  report_.uri = out.uri;
  report_.picture = output::name(out.picture);
  report_.size = stream_size(out.picture, view);
}
StreamSink::~StreamSink() = default;

Result<void> StreamSink::check(const scene::StreamOut& out, Size view, double rate_hz) {
  MIXRIG_ASSIGN(const StreamPlan plan, plan_with_host(out, view, rate_hz));
  return take::check_elements(needs_of(plan), "stream_out \"" + out.uri + "\"");
}

Result<std::unique_ptr<StreamSink>> StreamSink::create(const scene::StreamOut& wanted, Size view,
                                                       double rate_hz, bool transparent,
                                                       RoomBehind behind, DayAtZero day_at_zero) {
  scene::StreamOut out = wanted;
  MIXRIG_ASSIGN(StreamPlan plan, plan_with_host(out, view, rate_hz));
  if (plan.waits) out.uri = free_file(wanted.uri);
  if (out.uri != wanted.uri) {
    log_warning("output", "stream_out: '" + wanted.uri + "' is there and stays: this run writes '" +
                              out.uri + "'");
    MIXRIG_ASSIGN(plan, plan_stream(out, view, rate_hz));
  }
  MIXRIG_TRY(take::check_elements(needs_of(plan), "stream_out \"" + out.uri + "\""));
  std::unique_ptr<StreamSink> sink(
      new StreamSink(out, view, rate_hz, transparent, std::move(behind)));
  MIXRIG_ASSIGN(take::Pipeline pipeline, take::Pipeline::launch(plan.description, out.uri));
  const take::GstElementPtr end(pipeline.element("end"));
  for (const auto& [key, value] : plan.texts)
    g_object_set(end.get(), key.c_str(), value.c_str(), nullptr);
  if (plan.port) g_object_set(end.get(), "port", *plan.port, nullptr);
  take::GstElementPtr source(pipeline.element("source"));
  if (plan.sends_messages) mend_messages_of(take::GstElementPtr(pipeline.element("parse")));
  MIXRIG_TRY(pipeline.play());
  sink->graph_.reset(
      new Graph{std::move(pipeline), std::move(source), plan.waits, plan.i420, plan.calls});
  constexpr double kSlowest_hz = 0.5;
  if (plan.timecode && rate_hz >= kSlowest_hz)
    sink->timecode_.emplace(rate_hz, std::move(day_at_zero));
  if (!plan.caps.empty())
    log_info("output", "stream_out \"" + out.uri + "\": its reader needs the caps " + plan.caps);
  return sink;
}

/// Begins anew after a failure of an end that calls its receiver.
bool StreamSink::call_again(HostTime now) {
  if (!called_)
    log_warning("output", "stream_out \"" + out_.uri +
                              "\": nobody listens there: it is called again until somebody does");
  if (called_ && std::chrono::abs(now - *called_) < kCallEvery) return false;
  called_ = now;
  return graph_->pipeline.restart().has_value();
}

bool StreamSink::has_room(HostTime now) {
  if (ended_) return false;
  if (graph_->pipeline.has_failed()) {
    if (graph_->calls) return call_again(now);
    ended_ = true;
    log_warning("output", to_line(graph_->pipeline.error(ErrorCode::kIo,
                                                         "stream_out \"" + out_.uri + "\" ended")) +
                              ": nothing more is sent to it");
    return false;
  }
  return graph_->waits ||
         gst_app_src_get_current_level_buffers(GST_APP_SRC(graph_->source.get())) < kQueued;
}

Result<void> StreamSink::write(const CompositePtr& composite) {
  const HostTime exposed = composite->capture->mid_exposure;
  if (!first_) first_ = exposed;
  if (graph_->waits && graph_->pipeline.has_failed())
    return graph_->pipeline.error(ErrorCode::kIo, "cannot write '" + out_.uri + "'");
  if (!has_room(exposed)) {
    ++report_.dropped;
    return {};
  }
  const std::size_t stride = StreamPicture::stride(out_, view_);
  const std::size_t drawn = stride * static_cast<std::size_t>(view_.height);
  const Size size = stream_size(out_.picture, view_);
  const std::size_t bytes = graph_->i420 ? i420_bytes(size) : drawn;
  GstBuffer* const buffer = gst_buffer_new_allocate(nullptr, bytes, nullptr);
  GstMapInfo map;
  if (buffer == nullptr || gst_buffer_map(buffer, &map, GST_MAP_WRITE) == 0)
    return Error{ErrorCode::kIo, "stream_out \"" + out_.uri + "\": no memory for a picture"};
  const std::span<std::uint8_t> to(map.data, bytes);
  if (graph_->i420) {
    drawn_.resize(drawn);
    picture_.draw(composite->images, composite->view, drawn_);
    i420_from(drawn_, stride, bytes_per_pixel(pixels_of(out_.picture)), size, to);
  } else {
    picture_.draw(composite->images, composite->view, to);
  }
  gst_buffer_unmap(buffer, &map);
  last_ = std::max(exposed - *first_, last_ + Duration(1));
  GST_BUFFER_PTS(buffer) = static_cast<GstClockTime>(last_.count());
  if (timecode_) {
    const Timecode at = timecode_->next(exposed);
    gst_buffer_add_video_time_code_meta_full(buffer, timecode_->per_second(), 1, nullptr,
                                             GST_VIDEO_TIME_CODE_FLAGS_NONE, at.hours, at.minutes,
                                             at.seconds, at.frames, 0);
  }
  GST_BUFFER_DURATION(buffer) = static_cast<GstClockTime>(std::llround(1e9 / rate_hz_));
  if (gst_app_src_push_buffer(GST_APP_SRC(graph_->source.get()), buffer) == GST_FLOW_OK)
    ++report_.frames;
  else
    ++report_.dropped;
  return {};
}

Result<void> StreamSink::finish() {
  report_.stereo = picture_.stereo();
  gst_app_src_end_of_stream(GST_APP_SRC(graph_->source.get()));
  Result<void> done;
  if (graph_->waits)
    done = graph_->pipeline.wait_for(GST_MESSAGE_EOS, "write");
  else
    wait_shortly(graph_->pipeline.get());
  graph_.reset();
  return done;
}

}  // namespace mixrig::output

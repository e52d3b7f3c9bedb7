// SPDX-License-Identifier: Apache-2.0
#include "host/operator/page/webrtc/webrtc_peer.h"

#include <algorithm>
#include <cstring>
#include <mutex>
#include <utility>

#define GST_USE_UNSTABLE_API  // webrtcbin's descriptions
#include <gst/app/gstappsrc.h>
#include <gst/gst.h>
#include <gst/sdp/sdp.h>
#include <gst/webrtc/webrtc.h>

#include "host/capture/take/streams/gst_pipeline.h"

namespace mixrig::page {

/// State shared with GStreamer's threads; lives as long as one of them may use it.
struct WebrtcListener {
  std::mutex mutex;
  WebrtcPeer::Tell tell;
  bool offered = false;

  void say(Result<std::string> what) {
    const std::lock_guard lock(mutex);
    if (tell) tell(std::move(what));
  }
  void fail(const std::string& why) { say(Error{ErrorCode::kIo, "WebRTC: " + why}); }
};

namespace {

// Colours of VP8 are BT.601 where nothing else is said. Pictures are lost rather than late.
constexpr const char* kDescription =
    "webrtcbin name=peer bundle-policy=max-bundle "
    "appsrc name=source is-live=true format=time max-buffers=1 leaky-type=downstream "
    "! videoconvert n-threads=1 ! video/x-raw,format=I420,colorimetry=bt601 "
    "! vp8enc deadline=1 cpu-used=12 threads=1 end-usage=cbr target-bitrate=4000000 "
    "min-quantizer=4 max-quantizer=50 lag-in-frames=0 keyframe-max-dist=300 static-threshold=1 "
    "! rtpvp8pay pt=96 timestamp-offset=0 picture-id-mode=15-bit "
    "! application/x-rtp,media=video,encoding-name=VP8,payload=96,clock-rate=90000 ! peer.";

using ListenerPtr = std::shared_ptr<WebrtcListener>;

void delete_listener(gpointer listener, GClosure*) { delete static_cast<ListenerPtr*>(listener); }

/// Connects a signal whose user data is the listener.
void listen_to(gpointer object, const char* signal, GCallback callback, const ListenerPtr& to) {
  g_signal_connect_data(object, signal, callback, new ListenerPtr(to), delete_listener,
                        static_cast<GConnectFlags>(0));
}

struct DeletePromise {
  void operator()(GstPromise* promise) const { gst_promise_unref(promise); }
};
using Promise = std::unique_ptr<GstPromise, DeletePromise>;

/// Waits for what was asked of the peer, and returns why it failed; empty: it is done. A peer that
/// ends meanwhile would keep its ports for ever (GStreamer 1.22).
std::string error_of(GstPromise* promise) {
  if (gst_promise_wait(promise) != GST_PROMISE_RESULT_REPLIED) return "it ended";
  const GstStructure* const reply = gst_promise_get_reply(promise);
  if (reply == nullptr || gst_structure_has_field(reply, "error") == 0) return {};
  GError* error = nullptr;
  gst_structure_get(reply, "error", G_TYPE_ERROR, &error, nullptr);
  const std::string why = error != nullptr ? error->message : "unknown";
  g_clear_error(&error);
  return why;
}

/// Makes an offer and takes it as the local description: candidates are gathered then.
std::string make_offer(GstElement* peer) {
  const Promise made(gst_promise_new()), taken(gst_promise_new());
  g_signal_emit_by_name(peer, "create-offer", nullptr, made.get());
  if (std::string why = error_of(made.get()); !why.empty()) return why;
  GstWebRTCSessionDescription* offer = nullptr;
  gst_structure_get(gst_promise_get_reply(made.get()), "offer", GST_TYPE_WEBRTC_SESSION_DESCRIPTION,
                    &offer, nullptr);
  if (offer == nullptr) return "none was made";
  g_signal_emit_by_name(peer, "set-local-description", offer, taken.get());
  gst_webrtc_session_description_free(offer);
  return error_of(taken.get());
}

/// Called when the local description has its candidate.
void on_gathered(GstElement* peer, GParamSpec*, gpointer data) {
  WebrtcListener& listener = **static_cast<ListenerPtr*>(data);
  GstWebRTCICEGatheringState state = GST_WEBRTC_ICE_GATHERING_STATE_NEW;
  g_object_get(peer, "ice-gathering-state", &state, nullptr);
  if (state != GST_WEBRTC_ICE_GATHERING_STATE_COMPLETE || listener.offered) return;
  GstWebRTCSessionDescription* offer = nullptr;
  g_object_get(peer, "local-description", &offer, nullptr);
  if (offer == nullptr) return;
  gchar* const text = gst_sdp_message_as_text(offer->sdp);
  listener.offered = true;
  listener.say(std::string(text));
  g_free(text);
  gst_webrtc_session_description_free(offer);
}

void on_connection(GstElement* peer, GParamSpec*, gpointer data) {
  GstWebRTCPeerConnectionState state = GST_WEBRTC_PEER_CONNECTION_STATE_NEW;
  g_object_get(peer, "connection-state", &state, nullptr);
  if (state == GST_WEBRTC_PEER_CONNECTION_STATE_FAILED)
    (*static_cast<ListenerPtr*>(data))->fail("the browser cannot be reached");
  if (state == GST_WEBRTC_PEER_CONNECTION_STATE_CLOSED)
    (*static_cast<ListenerPtr*>(data))->fail("the browser has ended it");
}

/// Restricts the peer to one address and UDP.
Result<void> set_address(GstElement* peer, const std::string& address) {
  GObject *ice = nullptr, *agent = nullptr;
  gboolean fine = FALSE;
  g_object_get(peer, "ice-agent", &ice, nullptr);
  if (ice != nullptr) {
    g_signal_emit_by_name(ice, "add-local-ip-address", address.c_str(), &fine);
    g_object_get(ice, "agent", &agent, nullptr);
  }
  if (agent != nullptr) g_object_set(agent, "ice-tcp", FALSE, "upnp", FALSE, nullptr);
  const bool done = fine != FALSE && agent != nullptr;
  g_clear_object(&agent);
  g_clear_object(&ice);
  if (done) return {};
  return Error{ErrorCode::kIo, "WebRTC cannot be sent from " + address};
}

void send_only(GstElement* peer) {
  GstWebRTCRTPTransceiver* video = nullptr;
  g_signal_emit_by_name(peer, "get-transceiver", 0, &video);
  if (video == nullptr) return;
  g_object_set(video, "direction", GST_WEBRTC_RTP_TRANSCEIVER_DIRECTION_SENDONLY, nullptr);
  gst_object_unref(video);
}

GstBuffer* buffer_of(ImageView<const Rgb8> picture) {
  const std::size_t bytes = sizeof(Rgb8) * static_cast<std::size_t>(picture.size.width);
  const std::size_t stride = (bytes + 3) & ~std::size_t{3};  // as GStreamer lays RGB out
  GstBuffer* const buffer = gst_buffer_new_allocate(
      nullptr, stride * static_cast<std::size_t>(picture.size.height), nullptr);
  GstMapInfo map;
  if (buffer == nullptr || gst_buffer_map(buffer, &map, GST_MAP_WRITE) == 0) return nullptr;
  for (int y = 0; y < picture.size.height; ++y)
    std::memcpy(map.data + stride * static_cast<std::size_t>(y), picture.row(y), bytes);
  gst_buffer_unmap(buffer, &map);
  return buffer;
}

}  // namespace

struct WebrtcPeer::Graph {
  take::Pipeline pipeline;
  take::GstElementPtr peer, source;
  ListenerPtr listener;
  Size size{};
  std::optional<HostTime> first{};
  Duration last{};
};

WebrtcPeer::WebrtcPeer(std::unique_ptr<Graph> graph) : graph_(std::move(graph)) {}
WebrtcPeer::~WebrtcPeer() {
  const std::lock_guard lock(graph_->listener->mutex);
  graph_->listener->tell = {};
}

Result<std::shared_ptr<WebrtcPeer>> WebrtcPeer::create(const std::string& address, Tell tell) {
  constexpr const char *kBad = "gstreamer1.0-plugins-bad", *kNice = "gstreamer1.0-nice",
                       *kGood = "gstreamer1.0-plugins-good", *kBase = "gstreamer1.0-plugins-base";
  MIXRIG_TRY(take::check_elements({{"webrtcbin", kBad},
                                   {"dtlsdec", kBad},
                                   {"nicesink", kNice},
                                   {"vp8enc", kGood},
                                   {"rtpvp8pay", kGood},
                                   {"srtpenc", kBad},
                                   {"rtpbin", kGood},
                                   {"videoconvert", kBase}},
                                  "pictures by WebRTC"));
  MIXRIG_ASSIGN(take::Pipeline pipeline, take::Pipeline::launch(kDescription, "WebRTC"));
  auto listener = std::make_shared<WebrtcListener>();
  listener->tell = std::move(tell);
  take::GstElementPtr peer(pipeline.element("peer")), source(pipeline.element("source"));
  MIXRIG_TRY(set_address(peer.get(), address));
  send_only(peer.get());
  listen_to(peer.get(), "notify::ice-gathering-state", G_CALLBACK(on_gathered), listener);
  listen_to(peer.get(), "notify::connection-state", G_CALLBACK(on_connection), listener);
  MIXRIG_TRY(pipeline.play());
  if (const std::string why = make_offer(peer.get()); !why.empty())
    return Error{ErrorCode::kIo, "WebRTC: no offer: " + why};
  return std::shared_ptr<WebrtcPeer>(new WebrtcPeer(std::unique_ptr<Graph>(
      new Graph{std::move(pipeline), std::move(peer), std::move(source), std::move(listener)})));
}

void WebrtcPeer::take(const WebrtcAnswer& answer) {
  GstSDPMessage* message = nullptr;
  if (gst_sdp_message_new_from_text(webrtc_answer_text(answer).c_str(), &message) != GST_SDP_OK)
    return graph_->listener->fail("the answer cannot be read");
  GstWebRTCSessionDescription* const description =
      gst_webrtc_session_description_new(GST_WEBRTC_SDP_TYPE_ANSWER, message);
  const Promise taken(gst_promise_new());
  g_signal_emit_by_name(graph_->peer.get(), "set-remote-description", description, taken.get());
  gst_webrtc_session_description_free(description);
  if (const std::string why = error_of(taken.get()); !why.empty()) graph_->listener->fail(why);
}

std::optional<std::uint32_t> WebrtcPeer::put(ImageView<const Rgb8> picture, HostTime now) {
  GstAppSrc* const source = GST_APP_SRC(graph_->source.get());
  if (picture.size != graph_->size) {
    GstCaps* const caps = gst_caps_new_simple(
        "video/x-raw", "format", G_TYPE_STRING, "RGB", "width", G_TYPE_INT, picture.size.width,
        "height", G_TYPE_INT, picture.size.height, "framerate", GST_TYPE_FRACTION, 0, 1, nullptr);
    gst_app_src_set_caps(source, caps);
    gst_caps_unref(caps);
    graph_->size = picture.size;
  }
  GstBuffer* const buffer = buffer_of(picture);
  if (buffer == nullptr) return std::nullopt;
  if (!graph_->first) graph_->first = now;
  const Duration at = std::max(now - *graph_->first, graph_->last + Duration(1));
  constexpr Duration kLeast = std::chrono::milliseconds(10), kMost = std::chrono::seconds(1);
  // The encoder controls its bit rate by the duration.
  GST_BUFFER_DURATION(buffer) =
      static_cast<GstClockTime>(std::clamp(at - graph_->last, kLeast, kMost).count());
  GST_BUFFER_PTS(buffer) = static_cast<GstClockTime>(at.count());
  graph_->last = at;
  if (gst_app_src_push_buffer(source, buffer) != GST_FLOW_OK) return std::nullopt;
  return static_cast<std::uint32_t>(
      gst_util_uint64_scale_int(static_cast<guint64>(at.count()), 90000, GST_SECOND));
}

}  // namespace mixrig::page

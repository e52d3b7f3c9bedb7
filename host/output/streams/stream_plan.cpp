// SPDX-License-Identifier: Apache-2.0
#include "host/output/streams/stream_plan.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "host/output/streams/srt_keys.h"

namespace mixrig::output {
namespace {

using Picture = scene::StreamOut::Picture;
using Codec = scene::StreamOut::Codec;

constexpr const char* kGood = "gstreamer1.0-plugins-good";
constexpr const char* kBad = "gstreamer1.0-plugins-bad";
constexpr const char* kUgly = "gstreamer1.0-plugins-ugly";
constexpr const char* kLibav = "gstreamer1.0-libav";
constexpr const char* kBase = "gstreamer1.0-plugins-base";
constexpr std::array<const char*, 4> kFormats{"BGRx", "BGRA", "GRAY8", "GRAY16_LE"};

enum class Carrier { kSrt, kRtp, kShm, kV4l2, kMatroska, kMov, kMp4 };

struct Where {
  Carrier carrier;
  std::string rest;  ///< after the scheme; the whole URI of SRT; a file's path
};

Error stream_error(const scene::StreamOut& out, const std::string& what) {
  return {ErrorCode::kUsage, "stream_out \"" + out.uri + "\": " + what};
}

Result<Where> where_of(const scene::StreamOut& out) {
  const std::string_view uri = out.uri;
  constexpr std::array<std::pair<std::string_view, Carrier>, 4> kSchemes{
      {{"srt://", Carrier::kSrt},
       {"rtp://", Carrier::kRtp},
       {"shm://", Carrier::kShm},
       {"v4l2://", Carrier::kV4l2}}};
  for (const auto& [scheme, carrier] : kSchemes)
    if (uri.starts_with(scheme) && uri.size() > scheme.size())
      return Where{carrier,
                   std::string(carrier == Carrier::kSrt ? uri : uri.substr(scheme.size()))};
  if (uri.find("://") == std::string_view::npos) {
    if (uri.ends_with(".mkv")) return Where{Carrier::kMatroska, out.uri};
    if (uri.ends_with(".mov")) return Where{Carrier::kMov, out.uri};
    if (uri.ends_with(".mp4")) return Where{Carrier::kMp4, out.uri};
  }
  return stream_error(out,
                      "is no stream: give srt://HOST:PORT, rtp://HOST:PORT, shm://PATH, "
                      "v4l2://DEVICE, or a file .mkv, .mov or .mp4");
}

Codec codec_of(const scene::StreamOut& out, Carrier carrier) {
  if (out.codec != Codec::kAuto) return out.codec;
  switch (carrier) {
    case Carrier::kShm:
    case Carrier::kV4l2:
      return Codec::kRaw;
    case Carrier::kMatroska:
      return Codec::kFfv1;
    case Carrier::kMov:
      return Codec::kProres;
    case Carrier::kSrt:
      if (out.picture == Picture::kDepth || out.picture == Picture::kAlpha) return Codec::kFfv1;
      return Codec::kH264;
    case Carrier::kRtp:
    case Carrier::kMp4:
      break;
  }
  return Codec::kH264;
}

Result<void> check_codec(const scene::StreamOut& out, Carrier carrier, Codec codec) {
  const bool raw_carrier = carrier == Carrier::kShm || carrier == Carrier::kV4l2;
  if (raw_carrier != (codec == Codec::kRaw) && !(carrier == Carrier::kRtp && codec == Codec::kRaw))
    return stream_error(out,
                        fmt::format("cannot carry codec \"{}\": leave codec out", name(codec)));
  if ((carrier == Carrier::kMov) != (codec == Codec::kProres))
    return stream_error(out, "ProRes and files .mov belong together: give both, or neither");
  if (carrier == Carrier::kMp4 && codec != Codec::kH264)
    return stream_error(out, "an .mp4 carries H.264, which every browser plays: use .mkv for FFV1");
  if (carrier == Carrier::kRtp && codec == Codec::kFfv1)
    return stream_error(out, "RTP carries H.264 or raw pictures: use srt:// for FFV1");
  if (out.picture == Picture::kDepth && (codec == Codec::kH264 || codec == Codec::kProres ||
                                         carrier == Carrier::kV4l2 || carrier == Carrier::kRtp))
    return stream_error(out,
                        "depth has 16 bits, which only FFV1 (srt://, .mkv) and shm:// keep: use "
                        "one of them, or picture = \"2d+depth\"");
  if (out.picture == Picture::kAlpha && (codec == Codec::kH264 || carrier == Carrier::kV4l2))
    return stream_error(out,
                        "H.264 and v4l2 carry no alpha: use FFV1, ProRes, shm:// or rtp:// with "
                        "codec = \"raw\", or picture = \"fill+key\"");
  return {};
}

/// "HOST:PORT".
bool split_port(const std::string& text, std::string& host, int& port) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos || colon == 0) return false;
  const char* const end = text.data() + text.size();
  if (std::from_chars(text.data() + colon + 1, end, port).ptr != end) return false;
  host = text.substr(0, colon);
  return port >= 1 && port <= 65535;
}

void add_codec(const scene::StreamOut& out, Carrier carrier, Codec codec, StreamPlan& plan) {
  const auto need = [&plan](const char* element, const char* package) {
    plan.needs.push_back({element, package});
  };
  switch (codec) {
    case Codec::kFfv1:
      need("avenc_ffv1", kLibav), need("matroskamux", kGood);
      plan.description += " ! avenc_ffv1 gop-size=1 ! matroskamux";
      if (carrier == Carrier::kSrt) plan.description += " streamable=true";
      return;
    case Codec::kH264:
      plan.timecode = true;  // in messages that pic-struct makes and h264parse fills
      need("x264enc", kUgly);
      plan.description +=
          " ! x264enc tune=zerolatency speed-preset=veryfast pass=quant quantizer=16 "
          "key-int-max=25 option-string=pic-struct=1 ! h264parse name=parse update-timecode=true";
      need("h264parse", kBad);
      if (carrier == Carrier::kMatroska) {
        need("matroskamux", kGood);
        plan.description += " ! matroskamux";
        return;
      }
      if (carrier == Carrier::kMp4) {
        need("mp4mux", kGood);
        plan.description += " ! mp4mux";
        return;
      }
      need("mpegtsmux", kBad);
      plan.sends_messages = true;
      plan.description += " ! mpegtsmux alignment=7";
      if (carrier != Carrier::kRtp) return;
      need("rtpmp2tpay", kGood);
      plan.description += " ! rtpmp2tpay";
      return;
    case Codec::kProres:
      plan.timecode = true;  // a track of its own
      need("videoconvert", kBase), need("avenc_prores_ks", kLibav), need("qtmux", kGood);
      plan.description +=
          fmt::format(" ! videoconvert ! video/x-raw,format={} ! avenc_prores_ks ! qtmux",
                      out.picture == Picture::kAlpha ? "A444_10LE" : "Y444_10LE");
      return;
    case Codec::kRaw:
    case Codec::kAuto:
      break;
  }
  if (carrier == Carrier::kV4l2) {  // what cameras send, and so what every reader takes
    need("videoconvert", kBase);
    plan.description += " ! videoconvert ! video/x-raw,format=YUY2";
  }
  if (carrier != Carrier::kRtp) return;
  const char* const format = out.picture == Picture::kAlpha ? "BGRA" : "RGB";
  need("videoconvert", kBase), need("rtpvrawpay", kGood);
  plan.description += fmt::format(" ! videoconvert ! video/x-raw,format={} ! rtpvrawpay", format);
}

Result<void> add_end(const scene::StreamOut& out, const Where& where, std::size_t frame_bytes,
                     StreamPlan& plan) {
  const auto end = [&plan](const char* element, const char* package, const char* properties) {
    plan.needs.push_back({element, package});
    plan.description += fmt::format(" ! {} name=end sync=false {}", element, properties);
  };
  switch (where.carrier) {
    case Carrier::kSrt: {
      constexpr std::size_t kScheme = 6;  // "srt://"
      end("srtsink", kBad, "wait-for-connection=false");
      std::string uri = where.rest, host;
      // A listener without an address would hear the whole network.
      if (uri.starts_with("srt://:")) uri.insert(kScheme, "127.0.0.1");
      const std::size_t after = std::min(uri.find_first_of("/?", kScheme), uri.size());
      int port = 0;
      if (!split_port(uri.substr(kScheme, after - kScheme), host, port))
        return stream_error(out, "names no host and port: give srt://HOST:PORT");
      plan.texts.emplace_back("uri", uri);
      plan.host = host;
      const auto calls = srt_calls(std::string_view(uri).substr(std::min(uri.find('?'), uri.size())));
      if (!calls) return stream_error(out, calls.error().context);
      plan.calls = *calls;
      return {};
    }
    case Carrier::kRtp: {
      end("udpsink", kGood, "");
      std::string host;
      if (!split_port(where.rest, host, plan.port.emplace()))
        return stream_error(out, "names no host and port: give rtp://HOST:PORT");
      if (host == "localhost") host = "127.0.0.1";  // of the family that the socket is bound for
      plan.host = host;
      plan.texts.emplace_back("host", host);
      // Else its socket, which GStreamer does not connect, takes what any host sends.
      if (host.starts_with("127.")) plan.texts.emplace_back("bind-address", "127.0.0.1");
      return {};
    }
    case Carrier::kShm:
      plan.needs.push_back({"shmsink", kBad});
      plan.description += fmt::format(
          " ! shmsink name=end sync=false wait-for-connection=false shm-size={}", 4 * frame_bytes);
      plan.texts.emplace_back("socket-path", where.rest);
      return {};
    case Carrier::kV4l2:
      end("v4l2sink", kGood, "");
      plan.texts.emplace_back("device", where.rest);
      return {};
    case Carrier::kMatroska:
    case Carrier::kMov:
    case Carrier::kMp4:
      break;
  }
  end("filesink", kBase, "");
  plan.texts.emplace_back("location", where.rest);
  plan.waits = true;
  return {};
}

}  // namespace

const char* name(Picture picture) {
  constexpr std::array<const char*, 7> kNames{"fill",  "key",      "depth", "fill+key",
                                              "alpha", "2d+depth", "stereo"};
  return kNames[static_cast<std::size_t>(picture)];
}

const char* name(Codec codec) {
  constexpr std::array<const char*, 5> kNames{"auto", "ffv1", "h264", "prores", "raw"};
  return kNames[static_cast<std::size_t>(codec)];
}

std::size_t bytes_per_pixel(StreamPixels pixels) {
  constexpr std::array<std::size_t, 4> kBytes{4, 4, 1, 2};
  return kBytes[static_cast<std::size_t>(pixels)];
}

StreamPixels pixels_of(Picture picture) {
  switch (picture) {
    case Picture::kKey:
      return StreamPixels::kGray8;
    case Picture::kDepth:
      return StreamPixels::kGray16;
    case Picture::kAlpha:
      return StreamPixels::kBgra;
    default:
      return StreamPixels::kBgrx;
  }
}

Size stream_size(Picture picture, Size view) {
  const bool two =
      picture == Picture::kFillKey || picture == Picture::kDepth2d || picture == Picture::kStereo;
  return {two ? 2 * view.width : view.width, view.height};
}

Result<StreamPlan> plan_stream(const scene::StreamOut& out, Size view, double rate_hz) {
  MIXRIG_ASSIGN(const Where where, where_of(out));
  const Codec codec = codec_of(out, where.carrier);
  MIXRIG_TRY(check_codec(out, where.carrier, codec));
  const Size size = stream_size(out.picture, view);
  if (codec == Codec::kH264 && (size.width % 2 != 0 || size.height % 2 != 0))
    return stream_error(out, fmt::format("H.264 needs even sides, the picture has {}x{}: give "
                                         "codec = \"ffv1\" where it can be carried, or a camera "
                                         "size with even sides",
                                         size.width, size.height));
  const StreamPixels pixels = pixels_of(out.picture);
  StreamPlan plan;
  plan.i420 = codec == Codec::kH264;
  const std::string raw =
      fmt::format("video/x-raw,format={},width={},height={},framerate={}/1000",
                  plan.i420 ? "I420,colorimetry=bt709" : kFormats[static_cast<std::size_t>(pixels)],
                  size.width, size.height, std::lround(1000 * rate_hz));
  plan.needs.push_back({"appsrc", kBase});
  const bool to_file = where.carrier == Carrier::kMatroska || where.carrier == Carrier::kMov ||
                       where.carrier == Carrier::kMp4;
  plan.description =
      fmt::format("appsrc name=source format=time block={} max-bytes=0 max-buffers=2 caps={}",
                  to_file ? "true" : "false", raw);
  add_codec(out, where.carrier, codec, plan);
  const std::size_t stride =
      (static_cast<std::size_t>(size.width) * bytes_per_pixel(pixels) + 3) / 4 * 4;
  MIXRIG_TRY(add_end(out, where, stride * static_cast<std::size_t>(size.height), plan));
  if (where.carrier == Carrier::kShm) plan.caps = raw;
  return plan;
}

}  // namespace mixrig::output

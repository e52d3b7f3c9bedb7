// SPDX-License-Identifier: Apache-2.0
// Sends pictures to one browser by WebRTC, through GStreamer. Private to this module.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "hal/base/clock.h"
#include "hal/base/image.h"
#include "hal/base/result.h"
#include "host/operator/page/webrtc/webrtc_answer.h"

namespace mixrig::page {

/// VP8 in real time, one encoder a peer: of pictures that come faster than they are encoded the
/// newest is. It is reached at one address (UDP, a port that the system chooses), asks no server
/// for its address (no STUN, no TURN), and sends to nobody who has not come to that address with
/// the keys of the answer.
class WebrtcPeer {
 public:
  /// The offer to the browser, with the candidate in it; later, or instead, why there is no
  /// picture. Called on threads of GStreamer; must not wait.
  using Tell = std::function<void(Result<std::string> offer)>;

  /// Takes some 0.1 s. `address` is one of this machine. Errors: kUnsupported where a plug-in is
  /// missing, naming its Debian package; kIo.
  static Result<std::shared_ptr<WebrtcPeer>> create(const std::string& address, Tell tell);
  /// May take a while: threads of GStreamer end. After it `tell` is not called any more.
  ~WebrtcPeer();
  WebrtcPeer(const WebrtcPeer&) = delete;
  WebrtcPeer& operator=(const WebrtcPeer&) = delete;

  /// What comes of it is told. Once.
  void take(const WebrtcAnswer& answer);
  /// Gives a picture to the encoder, without waiting. Returns its RTP time stamp (90 kHz, modulo
  /// 2^32), by which the browser knows it; nothing where it could not be given. The stamp is of
  /// `now`, not of mid-exposure: browsers hold pictures back by how unevenly they come after their
  /// stamps. One thread at a time.
  std::optional<std::uint32_t> put(ImageView<const Rgb8> picture, HostTime now);

 private:
  struct Graph;
  explicit WebrtcPeer(std::unique_ptr<Graph> graph);
  std::unique_ptr<Graph> graph_;
};

}  // namespace mixrig::page

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

/// Encodes VP8 in real time, one encoder for each peer; pictures that come faster than they are
/// encoded are skipped, except the newest. The peer is reached at one address (UDP, a port that the
/// system chooses), asks no server for its address (no STUN, no TURN), and sends only to a client
/// that contacted that address with the keys of the answer.
class WebrtcPeer {
 public:
  /// Receives the offer to the browser with the candidate in it; later, or instead, an error that
  /// says why there is no picture. Called on threads of GStreamer; must not wait.
  using Tell = std::function<void(Result<std::string> offer)>;

  /// Makes a peer; takes some 0.1 s. `address` belongs to this machine. Errors: kUnsupported where
  /// a plug-in is missing, naming its Debian package; kIo.
  static Result<std::shared_ptr<WebrtcPeer>> create(const std::string& address, Tell tell);
  /// Ends threads of GStreamer, which may take a while. `tell` is not called afterwards.
  ~WebrtcPeer();
  WebrtcPeer(const WebrtcPeer&) = delete;
  WebrtcPeer& operator=(const WebrtcPeer&) = delete;

  /// Takes the browser's answer, once, and waits until that is done. Errors are passed to `tell`.
  void take(const WebrtcAnswer& answer);
  /// Gives a picture to the encoder, without waiting. Returns its RTP time stamp (90 kHz, modulo
  /// 2^32), by which the browser identifies it; nullopt where the encoder did not take it. The
  /// stamp is of `now`, not of mid-exposure: browsers delay pictures by the jitter between arrival
  /// and stamp. One thread at a time.
  std::optional<std::uint32_t> put(ImageView<const Rgb8> picture, HostTime now);

 private:
  struct Graph;
  explicit WebrtcPeer(std::unique_ptr<Graph> graph);
  std::unique_ptr<Graph> graph_;
};

}  // namespace mixrig::page

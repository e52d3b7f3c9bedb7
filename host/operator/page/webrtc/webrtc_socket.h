// SPDX-License-Identifier: Apache-2.0
// Socket of a browser that receives pictures by WebRTC, with its peer. Private to this module.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "host/operator/page/text_socket.h"
#include "host/operator/page/webrtc/webrtc_peer.h"

namespace mixrig::page {

inline constexpr int kMostPeers = 2;  ///< each has an encoder

/// Sends the offer and takes the browser's answer (webrtc_answer.h), then sends frame number,
/// mid-exposure and RTP time stamp of each picture, or the reason why there is no picture. Used on
/// the server's thread; GStreamer is begun and ended in Hub::peer_work.
class WebrtcSocket final : public TextSocket {
 public:
  WebrtcSocket(Hub& hub, boost::beast::tcp_stream stream, View view);
  ~WebrtcSocket() override;
  /// Ends the peer; may be called after the server's thread has ended.
  void end();

 private:
  void on_open() override;
  void on_message(const std::string& message) override;
  void on_end() override { end(); }
  void begin(Result<std::shared_ptr<WebrtcPeer>> made);
  void told(Result<std::string> offer);
  void refuse(const std::string& why);
  void tell_picture(int frame, HostTime mid_exposure, std::optional<std::uint32_t> rtp);
  std::weak_ptr<WebrtcSocket> weak() {
    return std::static_pointer_cast<WebrtcSocket>(shared_from_this());
  }

  View view_;
  std::shared_ptr<WebrtcPeer> peer_;
  std::optional<Result<std::string>> offer_;  ///< an offer that came before `peer_`
  std::optional<int> taker_;
  bool answered_ = false, ended_ = false;
};

}  // namespace mixrig::page

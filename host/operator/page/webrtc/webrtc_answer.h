// SPDX-License-Identifier: Apache-2.0
// What a browser says to be sent pictures by WebRTC. Of its session description (SDP, RFC 8866,
// RFC 8829) four values are read; the one that GStreamer is given is written anew from them. Pure.
#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "hal/base/result.h"
#include "host/output/sink/views.h"

namespace mixrig::page {

inline constexpr std::size_t kMostPeerMessage = std::size_t{64} << 10;

/// Candidates of the browser are not read: it sends to ours, and is answered where it sends from.
struct WebrtcAnswer {
  std::string user, password;  ///< of ICE
  std::string fingerprint;     ///< of its certificate: "AB:CD:...", 32 bytes
  bool active = true;          ///< it begins DTLS
  bool operator==(const WebrtcAnswer&) const = default;
};

/// Errors: kUsage, what is missing, doubled or wrong: other than one video stream of VP8 as payload
/// type 96, values that are no ICE characters, a fingerprint that is not SHA-256.
Result<WebrtcAnswer> parse_webrtc_answer(std::string_view sdp);
std::string webrtc_answer_text(const WebrtcAnswer& answer);

/// {"type": "request", "data": {"action": "answer", "sdp": ...}} or {"action": "view", "view":
/// ...}.
using PeerMessage = std::variant<WebrtcAnswer, output::View>;
/// Of an untrusted text of at most kMostPeerMessage bytes. Errors: kUsage.
Result<PeerMessage> parse_peer_message(std::string_view text);

}  // namespace mixrig::page

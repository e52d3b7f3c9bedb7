// SPDX-License-Identifier: Apache-2.0
// Answer of a browser that wants pictures by WebRTC. Only four values of its session description
// (SDP, RFC 8866, RFC 8829) are read; GStreamer gets a description written anew from them. Pure.
#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "hal/base/result.h"
#include "host/output/sink/views.h"

namespace mixrig::page {

inline constexpr std::size_t kMostPeerMessage = std::size_t{64} << 10;

/// The values read from the browser's answer. Its candidates are ignored: it sends to our
/// candidate, and is answered at the address it sends from.
struct WebrtcAnswer {
  std::string user, password;  ///< ICE credentials
  std::string fingerprint;     ///< SHA-256 of its certificate: "AB:CD:...", 32 bytes
  bool active = true;          ///< the browser begins DTLS
  bool operator==(const WebrtcAnswer&) const = default;
};

/// Parses a session description. Errors: kUsage, naming what is missing, doubled or wrong: other
/// than one video stream of VP8 as payload type 96, values that are not ICE characters, a
/// fingerprint that is not SHA-256.
Result<WebrtcAnswer> parse_webrtc_answer(std::string_view sdp);
std::string webrtc_answer_text(const WebrtcAnswer& answer);

/// Message of a browser: {"type": "request", "data": {"action": "answer", "sdp": ...}} or
/// {"action": "view", "view": ...}.
using PeerMessage = std::variant<WebrtcAnswer, output::View>;
/// Parses an untrusted text of at most kMostPeerMessage bytes. Errors: kUsage.
Result<PeerMessage> parse_peer_message(std::string_view text);

}  // namespace mixrig::page

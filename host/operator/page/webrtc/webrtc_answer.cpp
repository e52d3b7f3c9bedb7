// SPDX-License-Identifier: Apache-2.0
#include "host/operator/page/webrtc/webrtc_answer.h"

#include <algorithm>
#include <optional>

#include "host/operator/page/json_body.h"

namespace mixrig::page {
namespace {

Error no_answer(const std::string& why) {
  return {ErrorCode::kUsage, "the answer is not of a browser that takes VP8: " + why};
}

bool is_alphanumeric(char c) {
  return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
}

/// Whether a text has `least` to 256 characters, all ice-char of RFC 8839.
bool is_ice_text(std::string_view text, std::size_t least) {
  constexpr std::size_t kMost = 256;
  return text.size() >= least && text.size() <= kMost &&
         std::all_of(text.begin(), text.end(),
                     [](char c) { return is_alphanumeric(c) || c == '+' || c == '/'; });
}

bool is_fingerprint(std::string_view text) {
  constexpr std::size_t kBytes = 32;
  if (text.size() != 3 * kBytes - 1) return false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool hex = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'F') || (c >= 'a' && c <= 'f');
    if (i % 3 == 2 ? c != ':' : !hex) return false;
  }
  return true;
}

/// Takes the next line off `text`. Lines end with CR LF or LF.
std::string_view next_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

/// Whether a line such as "m=video 9 UDP/TLS/RTP/SAVPF 96 97" takes our video: it is not refused
/// (port 0), and 96 is among its formats.
bool takes_our_video(std::string_view line) {
  constexpr std::string_view kProfile = " UDP/TLS/RTP/SAVPF ";
  const std::size_t at = line.find(kProfile);
  if (!line.starts_with("m=video ") || line.starts_with("m=video 0 ") ||
      at == std::string_view::npos)
    return false;
  const std::string formats = " " + std::string(line.substr(at + kProfile.size())) + " ";
  return formats.find(" 96 ") != std::string::npos;
}

/// The value of an attribute that is there once, or again with the same value.
class Once {
 public:
  explicit Once(std::string_view name) : start_("a=" + std::string(name) + ":") {}
  void look(std::string_view line) {
    if (!line.starts_with(start_)) return;
    const std::string_view value = line.substr(start_.size());
    differs_ = differs_ || (value_ && *value_ != value);
    value_ = value;
  }
  std::string_view value() const { return differs_ ? std::string_view() : value_.value_or(""); }

 private:
  std::string start_;
  std::optional<std::string_view> value_;
  bool differs_ = false;
};

}  // namespace

Result<WebrtcAnswer> parse_webrtc_answer(std::string_view sdp) {
  constexpr std::string_view kHash = "sha-256 ";
  if (!sdp.starts_with("v=0")) return no_answer("it is no session description");
  Once user("ice-ufrag"), password("ice-pwd"), fingerprint("fingerprint"), setup("setup");
  int media = 0;
  bool video = false;
  while (!sdp.empty()) {
    const std::string_view line = next_line(sdp);
    if (line.starts_with("m=")) ++media, video = takes_our_video(line);
    for (Once* one : {&user, &password, &fingerprint, &setup}) one->look(line);
  }
  if (media != 1 || !video) return no_answer("it takes no VP8, or more than one stream");
  if (!is_ice_text(user.value(), 4)) return no_answer("ice-ufrag");
  if (!is_ice_text(password.value(), 22)) return no_answer("ice-pwd");
  if (!fingerprint.value().starts_with(kHash) ||
      !is_fingerprint(fingerprint.value().substr(kHash.size())))
    return no_answer("fingerprint");
  if (setup.value() != "active" && setup.value() != "passive") return no_answer("setup");
  return WebrtcAnswer{std::string(user.value()), std::string(password.value()),
                      std::string(fingerprint.value().substr(kHash.size())),
                      setup.value() == "active"};
}

std::string webrtc_answer_text(const WebrtcAnswer& answer) {
  return "v=0\r\no=- 1 1 IN IP4 127.0.0.1\r\ns=-\r\nt=0 0\r\na=group:BUNDLE video0\r\n"
         "m=video 9 UDP/TLS/RTP/SAVPF 96\r\nc=IN IP4 0.0.0.0\r\na=rtcp:9 IN IP4 0.0.0.0\r\n"
         "a=ice-ufrag:" +
         answer.user + "\r\na=ice-pwd:" + answer.password + "\r\na=fingerprint:sha-256 " +
         answer.fingerprint + "\r\na=setup:" + (answer.active ? "active" : "passive") +
         "\r\na=mid:video0\r\na=recvonly\r\na=rtcp-mux\r\na=rtcp-rsize\r\na=rtpmap:96 VP8/90000\r\n"
         "a=rtcp-fb:96 nack pli\r\n";
}

Result<PeerMessage> parse_peer_message(std::string_view text) {
  const Error shape{ErrorCode::kUsage,
                    "a message is {\"type\": \"request\", \"data\": {\"action\": \"answer\", "
                    "\"sdp\": ...}} or has \"action\": \"view\", \"view\": ..."};
  if (text.size() > kMostPeerMessage) return shape;
  MIXRIG_ASSIGN(const nlohmann::json message, parse_json(text));
  if (!message.is_object() || message.value("type", nlohmann::json()) != "request" ||
      !message.contains("data") || !message["data"].is_object())
    return shape;
  const nlohmann::json& data = message["data"];
  const auto word = [&](const char* key) {
    const auto found = data.find(key);
    return found != data.end() && found->is_string() ? found->get<std::string>() : std::string();
  };
  if (word("action") == "view") {
    if (const auto view = output::view_named(word("view"))) return PeerMessage(*view);
    return shape;
  }
  if (word("action") != "answer") return shape;
  MIXRIG_ASSIGN(WebrtcAnswer answer, parse_webrtc_answer(word("sdp")));
  return PeerMessage(std::move(answer));
}

}  // namespace mixrig::page

// SPDX-License-Identifier: Apache-2.0
#include "host/operator/page/webrtc/webrtc_answer.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace mixrig::page {
namespace {

/// Complete answer of Chromium 156 to the rig's offer.
constexpr const char* kChromium =
    "v=0\r\no=- 877749325845258572 2 IN IP4 127.0.0.1\r\ns=-\r\nt=0 0\r\na=group:BUNDLE video0\r\n"
    "a=msid-semantic: WMS\r\nm=video 9 UDP/TLS/RTP/SAVPF 96\r\nc=IN IP4 0.0.0.0\r\n"
    "a=rtcp:9 IN IP4 0.0.0.0\r\n"
    "a=candidate:2289071177 1 udp 2113937151 0f7575c4-c9c9-4d07-a5a0-30f6ce7bedfa.local 36779 typ "
    "host generation 0 network-cost 999\r\n"
    "a=ice-ufrag:/2F7\r\na=ice-pwd:J1BoWW/X4quN6Jtsw2OIpoQr\r\na=ice-options:trickle\r\n"
    "a=fingerprint:sha-256 "
    "89:50:98:1D:48:EC:00:A4:02:DC:3D:FC:F7:99:E6:0D:8F:E9:52:B6:F8:92:73:D4:A1:84:02:01:12:ED:A7:"
    "F8\r\na=setup:active\r\na=mid:video0\r\na=recvonly\r\na=rtcp-mux\r\na=rtcp-rsize\r\n"
    "a=rtpmap:96 VP8/90000\r\na=rtcp-fb:96 transport-cc\r\na=rtcp-fb:96 ccm fir\r\n"
    "a=rtcp-fb:96 nack pli\r\n";

std::string with(const std::string& from, const std::string& to) {
  std::string text = kChromium;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(WebrtcAnswer, FourValuesOfABrowsersAnswerAreRead) {
  const auto answer = parse_webrtc_answer(kChromium);
  ASSERT_TRUE(answer) << to_line(answer.error());
  EXPECT_EQ(answer->user, "/2F7");
  EXPECT_EQ(answer->password, "J1BoWW/X4quN6Jtsw2OIpoQr");
  EXPECT_EQ(answer->fingerprint.substr(0, 8), "89:50:98");
  EXPECT_TRUE(answer->active);
  EXPECT_FALSE(parse_webrtc_answer(with("setup:active", "setup:passive"))->active);
}

TEST(WebrtcAnswer, WhatGStreamerIsGivenIsWrittenAnew) {
  const auto answer = parse_webrtc_answer(with("s=-", "s=evil\r\na=tool:evil"));
  ASSERT_TRUE(answer);
  const std::string text = webrtc_answer_text(*answer);
  EXPECT_EQ(text.find("evil"), std::string::npos);
  EXPECT_EQ(text.find("candidate"), std::string::npos) << "the rig sends to nobody it is told of";
  EXPECT_EQ(parse_webrtc_answer(text).value(), *answer);
}

TEST(WebrtcAnswer, WhatIsMissingDoubledOrWrongIsRefused) {
  for (const std::string& bad : {
           std::string(),
           std::string("v=0"),
           std::string(kChromium).substr(1),
           with("m=video 9", "m=video 0"),
           with("m=video", "m=audio"),
           with("SAVPF 96", "SAVPF 97 960 196"),
           with("UDP/TLS/RTP/SAVPF", "RTP/AVP"),
           with("a=mid:video0", "m=video 9 UDP/TLS/RTP/SAVPF 96"),
           with("a=ice-ufrag:/2F7\r\n", ""),
           with("ice-ufrag:/2F7", "ice-ufrag:/2F"),
           with("ice-ufrag:/2F7", "ice-ufrag:/2F7 evil"),
           with("ice-ufrag:/2F7", "ice-ufrag:/2F7\r\na=ice-ufrag:other"),
           with("ice-ufrag:/2F7", "ice-ufrag:" + std::string(257, 'a')),
           with("ice-pwd:J1BoWW", "ice-pwd:J"),
           with("ice-pwd:J1", "ice-pwd:\"1"),
           with("sha-256", "sha-1"),
           with("89:50", "89:5"),
           with("89:50", "8G:50"),
           with("89:50", "89-50"),
           with("setup:active", "setup:actpass"),
           with("a=setup:active\r\n", ""),
       })
    EXPECT_FALSE(parse_webrtc_answer(bad)) << bad;
}

std::string message(const nlohmann::json& data) {
  return nlohmann::json{{"type", "request"}, {"data", data}}.dump();
}

TEST(WebrtcAnswer, MessagesAreAnAnswerOrAView) {
  const auto answer = parse_peer_message(message({{"action", "answer"}, {"sdp", kChromium}}));
  ASSERT_TRUE(answer);
  EXPECT_EQ(std::get<WebrtcAnswer>(*answer).user, "/2F7");
  const auto view = parse_peer_message(message({{"action", "view"}, {"view", "key"}}));
  ASSERT_TRUE(view);
  EXPECT_EQ(std::get<output::View>(*view), output::View::kKey);
  for (const std::string& bad :
       {std::string(), std::string("x"), std::string("[]"), std::string("{}"),
        std::string(R"({"type":"request"})"), std::string(R"({"type":"request","data":7})"),
        message({{"action", "view"}, {"view", "x"}}), message({{"action", "view"}, {"view", 7}}),
        message({{"action", "answer"}}), message({{"action", "answer"}, {"sdp", "v=0"}}),
        message({{"action", "offer"}, {"sdp", kChromium}}), message({{"sdp", kChromium}}),
        std::string(40, '['),
        message({{"action", "answer"}, {"sdp", kChromium + std::string(kMostPeerMessage, ' ')}})})
    EXPECT_FALSE(parse_peer_message(bad)) << bad.substr(0, 200);
}

}  // namespace
}  // namespace mixrig::page

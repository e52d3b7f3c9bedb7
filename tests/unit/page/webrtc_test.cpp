// SPDX-License-Identifier: Apache-2.0
// The socket by which a browser is sent pictures; the browser itself is in tests/browser.
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/progress.h"
#include "tests/support/throw_in.h"
#include "tests/unit/page/page_server.h"

namespace mixrig::page {
namespace {

using nlohmann::json;
using test::comes_true;

/// "0100007F:C35D" of each UDP socket of this process, IPv6 too.
std::set<std::string> udp_ports() {
  std::set<std::string> inodes, ports;
  std::error_code code;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", code)) {
    const std::string target = std::filesystem::read_symlink(entry.path(), code).string();
    if (target.starts_with("socket:[")) inodes.insert(target.substr(8, target.size() - 9));
  }
  for (const char* table : {"/proc/self/net/udp", "/proc/self/net/udp6"}) {
    std::ifstream file(table);
    std::string line;
    std::getline(file, line);
    while (std::getline(file, line)) {
      std::istringstream words(line);
      std::vector<std::string> word;
      for (std::string one; words >> one;) word.push_back(one);
      if (word.size() > 9 && inodes.contains(word[9])) ports.insert(word[1]);
    }
  }
  return ports;
}

class PageWebrtc : public PageServer {
 protected:
  std::unique_ptr<RawClient> open() const {
    auto client = std::make_unique<RawClient>(server_->port());
    client->send(upgrade("", "/api/v1/picture/composite.webrtc"));
    EXPECT_NE(client->read_to("\r\n\r\n").find("101"), std::string::npos);
    return client;
  }
  static json event(RawClient& client) {
    const std::string text = client.message();
    return text.empty() ? json{{"action", "closed"}} : json::parse(text)["data"];
  }
  static void request(RawClient& client, const json& data) {
    client.send_message(json{{"type", "request"}, {"data", data}}.dump());
  }
  static std::string answer() {
    std::string hex = "00";
    for (int i = 1; i < 32; ++i) hex += ":00";
    return "v=0\r\nm=video 9 UDP/TLS/RTP/SAVPF 96\r\na=ice-ufrag:abcd\r\na=ice-pwd:" +
           std::string(22, 'x') + "\r\na=fingerprint:sha-256 " + hex + "\r\na=setup:active\r\n";
  }
};

TEST_F(PageWebrtc, AnOfferIsOfOnePortOfThisMachineAlone) {
  EXPECT_TRUE(udp_ports().empty());
  auto client = open();
  const json offer = event(*client);
  ASSERT_EQ(offer["action"], "offer") << offer;
  const std::string sdp = offer["sdp"];
  const std::regex candidate("a=candidate:[^\r]*");
  const auto begin = std::sregex_iterator(sdp.begin(), sdp.end(), candidate);
  ASSERT_EQ(std::distance(begin, std::sregex_iterator()), 1) << sdp;
  std::smatch found;
  const std::string line = begin->str();
  ASSERT_TRUE(std::regex_search(line, found,
                                std::regex("(?:udp|UDP) \\d+ 127\\.0\\.0\\.1 (\\d+) typ host")))
      << line;
  std::ostringstream port;
  port << "0100007F:" << std::uppercase << std::hex << std::stoi(found[1]);
  EXPECT_EQ(udp_ports(), std::set<std::string>{port.str()});
  client->close();
  EXPECT_TRUE(comes_true([] { return udp_ports().empty(); })) << "who goes frees the port";
  EXPECT_TRUE(comes_true([&] { return sink_->wanted(1) == 0; })) << "nobody looks any more";
}

TEST_F(PageWebrtc, EachPictureIsToldWithItsTimeStamp) {
  auto client = open();
  ASSERT_EQ(event(*client)["action"], "offer");
  ASSERT_EQ(sink_->wanted(1), render::kColor);
  double last_rtp = -1, last_ms = 0;
  for (int number = 5; number < 8; ++number) {
    const double before_ms = milliseconds(clock_.now().time_since_epoch());
    frame(number);
    const json told = event(*client);
    ASSERT_EQ(told["action"], "picture");
    EXPECT_EQ(told["frame"], number);
    EXPECT_GT(told["rtp"], last_rtp);
    EXPECT_GT(told["captured_ms"], last_ms);
    EXPECT_NEAR(told["captured_ms"].get<double>(),
                0.5 * (before_ms + milliseconds(clock_.now().time_since_epoch())),
                0.51 * (milliseconds(clock_.now().time_since_epoch()) - before_ms) + 0.001);
    last_rtp = told["rtp"], last_ms = told["captured_ms"];
  }
  request(*client, {{"action", "view"}, {"view", "key"}});
  EXPECT_TRUE(comes_true([&] { return sink_->wanted(8) == render::kState; }));
}

TEST_F(PageWebrtc, TheThirdIsToldThatTwoAreTheMost) {
  auto a = open(), b = open();
  EXPECT_EQ(event(*a)["action"], "offer");
  EXPECT_EQ(event(*b)["action"], "offer");
  const json third = event(*open());
  EXPECT_EQ(third["action"], "refused");
  EXPECT_NE(third["error"].get<std::string>().find("two browsers"), std::string::npos);
  a->close();
  EXPECT_TRUE(comes_true([&] { return event(*open())["action"] == "offer"; }));
}

TEST_F(PageWebrtc, WhatItsThreadThrowsIsToldToTheBrowser) {
  {
    const test::ThrowIn thrown("WebRTC");
    const json told = event(*open());
    EXPECT_EQ(told["action"], "refused");
    EXPECT_NE(told["error"].get<std::string>().find("WebRTC: no memory is left"),
              std::string::npos);
  }
  EXPECT_TRUE(comes_true([&] { return event(*open())["action"] == "offer"; }));
}

TEST_F(PageWebrtc, WhoMayNotUseThePageGetsNoOffer) {
  const std::string target = "/api/v1/picture/composite.webrtc";
  EXPECT_EQ(ask(upgrade("Origin: http://evil.example\r\n", target)).status, 403);
  EXPECT_EQ(ask(upgrade("Host: evil.example\r\n", target)).status, 400);
  EXPECT_EQ(ask(get(target)).status, 426);
  EXPECT_EQ(ask(with_body("PUT " + target, "{}")).status, 405);
  EXPECT_TRUE(udp_ports().empty());
}

TEST_F(PageWebrtc, WrongMessagesAreRefusedAndTheServerLives) {
  auto client = open();
  ASSERT_EQ(event(*client)["action"], "offer");
  for (const char* text : {"", "x", "[]", R"({"type":"request","data":{"action":"answer"}})"}) {
    client->send_message(text);
    EXPECT_EQ(event(*client)["action"], "refused") << text;
  }
  request(*client, {{"action", "answer"}, {"sdp", answer()}});
  request(*client, {{"action", "answer"}, {"sdp", answer()}});
  const json twice = event(*client);
  EXPECT_EQ(twice["action"], "refused");
  EXPECT_NE(twice["error"].get<std::string>().find("no offer"), std::string::npos);
  EXPECT_EQ(ask(get("/api/v1/state")).status, 200);
}

TEST_F(PageWebrtc, EndsWhilePeersAreThere) {
  auto asked = open(), offered = open();
  ASSERT_EQ(event(*offered)["action"], "offer");
  request(*offered, {{"action", "answer"}, {"sdp", answer()}});
  frame(1);
  server_.reset();
  frame(2);  // the sink may outlive it
  EXPECT_TRUE(udp_ports().empty());
}

}  // namespace
}  // namespace mixrig::page

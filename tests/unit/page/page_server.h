// SPDX-License-Identifier: Apache-2.0
// A served page, and requests to it.
#pragma once

#include <gtest/gtest.h>

#include "host/operator/page/server.h"
#include "tests/unit/page/fake_operator.h"
#include "tests/unit/page/raw_client.h"

namespace mixrig::page {

class PageServer : public ::testing::Test {
 protected:
  PageServer() {
    State state;
    state.scene = "scene.toml";
    state.lamps.push_back({.name = "lamp 1"});
    run_.set(state);
    auto server = Server::start(run_, orders_, clock_, {"127.0.0.1", 0});
    if (server) server_ = *std::move(server);
    sink_ = server_->make_sink();
  }
  std::string host() const { return "127.0.0.1:" + std::to_string(server_->port()); }
  std::string get(const std::string& target, const std::string& more = "") const {
    return "GET " + target + " HTTP/1.1\r\nHost: " + host() + "\r\n" + more + "\r\n";
  }
  std::string with_body(const std::string& line, const std::string& body,
                        const std::string& type = "application/json",
                        const std::string& more = "") const {
    return line + " HTTP/1.1\r\nHost: " + host() + "\r\nContent-Type: " + type +
           "\r\nContent-Length: " + std::to_string(body.size()) + "\r\n" + more + "\r\n" + body;
  }
  RawClient::Response ask(const std::string& request) const {
    RawClient client(server_->port());
    client.send(request);
    return client.response();
  }
  /// Gives the sink one frame of a run; the sink is asked and fed as SinkThread does.
  void frame(int number, Size size = {32, 24}) {
    if (sink_->wanted(number) == 0) return;
    auto composite = std::make_shared<output::Composite>();
    auto capture = std::make_shared<capture::Capture>();
    capture->number = number;
    capture->mid_exposure = clock_.now();
    composite->capture = capture;
    composite->images.wanted = render::kComposite;
    composite->images.color.reset(size);
    for (int y = 0; y < size.height; ++y)  // noise, which does not compress
      for (int x = 0; x < size.width; ++x) {
        noise_ = noise_ * 1664525U + 1013904223U;
        composite->images.color.at(x, y) = {static_cast<std::uint8_t>(noise_ >> 24),
                                            static_cast<std::uint8_t>(noise_ >> 16),
                                            static_cast<std::uint8_t>(noise_ >> 8)};
      }
    ASSERT_TRUE(sink_->write(composite));
  }
  std::string upgrade(const std::string& more = "",
                      const std::string& target = "/api/v1/event/websocket") const {
    return get(target,
               "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
               "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
                   more);
  }

  SystemClock clock_;
  FakeOperator run_;
  std::atomic<bool> stop_ = false;
  output::RunOrders orders_{stop_};
  std::unique_ptr<Server> server_;
  std::unique_ptr<output::CompositeSink> sink_;
  unsigned noise_ = 1;
};

}  // namespace mixrig::page

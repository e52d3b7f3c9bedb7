// SPDX-License-Identifier: Apache-2.0
// A host that opens connections without end, with the token and without it.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <deque>
#include <thread>

#include <gtest/gtest.h>

#include "host/operator/page/server.h"
#include "tests/support/progress.h"
#include "tests/unit/page/fake_operator.h"
#include "tests/unit/page/raw_client.h"

namespace mixrig::page {
namespace {

constexpr std::size_t kHeld = 500;
constexpr std::uint32_t kFloodingHost = INADDR_LOOPBACK + 7;

/// Holds kHeld connections to a port and replaces the oldest, one after the other, until it ends.
class Flood {
 public:
  Flood(std::uint16_t port, std::string sent)
      : thread_([this, port, sent = std::move(sent)] {
          std::deque<RawClient> held;
          while (!ends_) {
            held.emplace_back(port, 0, kFloodingHost).send(sent);
            if (held.size() > kHeld) held.pop_front();
            ++opened_;
          }
        }) {}
  ~Flood() {
    ends_ = true;
    thread_.join();
  }
  Flood(const Flood&) = delete;
  Flood& operator=(const Flood&) = delete;
  std::size_t opened() const { return opened_; }

 private:
  std::atomic<bool> ends_ = false;
  std::atomic<std::size_t> opened_ = 0;
  std::thread thread_;
};

/// Each request of the operator, on a new connection and on one that stays, is answered. How long
/// the slowest took is printed, not judged: the machine may be busy.
TEST(PageServerFlood, EveryRequestOfTheOperatorIsAnswered) {
  constexpr int kRequests = 100;
  SystemClock clock;
  FakeOperator run;
  std::atomic<bool> stop = false;
  output::RunOrders orders(stop);
  const auto server = Server::start(run, orders, clock, {"0.0.0.0", 0});
  ASSERT_TRUE(server);
  const std::uint16_t port = (*server)->port();
  const std::string token =
      "Authorization: Bearer " + (*server)->url().substr((*server)->url().find("token=") + 6);
  const std::string head = "GET /api/v1/view HTTP/1.1\r\nHost: rig.local\r\n";
  const std::string request = head + token + "\r\n\r\n";
  for (const std::string& sent : {std::string(), head, head + "\r\n", request}) {
    RawClient page(port);
    page.send(request);
    ASSERT_EQ(page.response().status, 200);
    const Flood flood(port, sent);
    ASSERT_TRUE(test::comes_true([&] { return flood.opened() > kHeld; }));
    int answered = 0;
    std::chrono::duration<double, std::milli> slowest{};
    for (int i = 0; i < kRequests; ++i) {
      const auto begin = std::chrono::steady_clock::now();
      RawClient visitor(port);
      visitor.send(request);
      answered += visitor.response().status == 200;
      page.send(request);
      answered += page.response().status == 200;
      slowest = std::max(slowest, decltype(slowest)(std::chrono::steady_clock::now() - begin));
    }
    EXPECT_EQ(answered, 2 * kRequests) << sent;
    std::printf("%zu connections of one host: the slowest of %d requests took %.1f ms\n",
                flood.opened(), 2 * kRequests, slowest.count());
  }
}

}  // namespace
}  // namespace mixrig::page

// SPDX-License-Identifier: Apache-2.0
// A host that opens connections without end, with the token and without it.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <deque>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "host/operator/page/server.h"
#include "host/operator/page/visitors.h"
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

/// Connections that come while the server is at work with another request, each with a request.
class PageServerBusy : public ::testing::Test {
 protected:
  void SetUp() override {
    server_ = Server::start(run_, orders_, clock_, {"127.0.0.1", 0});
    ASSERT_TRUE(server_);
    held_ = run_.hold();
    open(INADDR_LOOPBACK, 1);
  }
  void open(std::uint32_t host, int count) {
    for (int i = 0; i < count; ++i)
      clients_.emplace_back((*server_)->port(), 0, host)
          .send("GET /api/v1/view HTTP/1.1\r\nHost: localhost\r\n\r\n");
  }
  /// Lets the server go on, and returns the status of each answer; 0: ended without one.
  std::vector<int> statuses() {
    held_.unlock();
    std::vector<int> list;
    for (RawClient& client : clients_) list.push_back(client.response().status);
    return list;
  }

 private:
  SystemClock clock_;
  FakeOperator run_;
  std::atomic<bool> stop_ = false;
  output::RunOrders orders_{stop_};
  Result<std::unique_ptr<Server>> server_ = std::unique_ptr<Server>();
  std::unique_lock<std::mutex> held_;
  std::deque<RawClient> clients_;
};

TEST_F(PageServerBusy, FewConnectionsOfAHostAreServedBeforeTheNextOne) {
  open(kFloodingHost, 400);
  open(INADDR_LOOPBACK, 1);
  const std::vector<int> statuses = this->statuses();
  EXPECT_EQ(statuses.front(), 200);
  EXPECT_EQ(statuses.back(), 200);
  EXPECT_LE(std::count(statuses.begin(), statuses.end(), 200),
            3 * static_cast<int>(Visitors::kMostGuests));
}

/// More than an address may have at work at once.
TEST_F(PageServerBusy, RequestsThatComeTogetherWaitForEachOther) {
  open(INADDR_LOOPBACK, 30);
  EXPECT_EQ(statuses(), std::vector<int>(31, 200));
}

}  // namespace
}  // namespace mixrig::page

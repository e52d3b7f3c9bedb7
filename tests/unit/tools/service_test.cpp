// SPDX-License-Identifier: Apache-2.0
// mixrig run as a service: what a service manager hears of it (sd_notify), its exit status, and
// signals.
#include <array>
#include <csignal>
#include <cstddef>

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "host/tools/stop_on_signal.h"
#include "tests/unit/tools/tiny_take.h"

namespace mixrig::test {
namespace {

class RunAsService : public ::testing::Test {
 protected:
  RunAsService() {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    take_.path("notify").string().copy(address.sun_path, sizeof address.sun_path - 1);
    EXPECT_EQ(::bind(manager_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  }
  ~RunAsService() override { ::close(manager_); }
  Outcome run(const std::string& scene) const {
    return take_.mixrig("run " + scene + " --source take:take --backend cpu",
                        "NOTIFY_SOCKET=" + take_.path("notify").string());
  }
  /// The next message; empty where there is none.
  std::string heard() const {
    std::array<char, 256> bytes{};
    const ssize_t size = ::recv(manager_, bytes.data(), bytes.size(), MSG_DONTWAIT);
    return {bytes.data(), static_cast<std::size_t>(std::max<ssize_t>(size, 0))};
  }

  TinyTake take_;
  int manager_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
};

TEST_F(RunAsService, TheFirstCompositeMakesItReady) {
  const Outcome outcome = run("scene.toml");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const std::string first = heard();
  EXPECT_TRUE(first.starts_with("READY=1\nWATCHDOG=1\nSTATUS=frame 4 composited")) << first;
}

TEST_F(RunAsService, AMissingSceneIsNoReasonToTryAgainAndNeverReady) {
  EXPECT_EQ(run("none.toml").status, 2) << "RestartPreventExitStatus of mixrig.service";
  EXPECT_EQ(heard(), "");
}

TEST(StopOnSignal, AClosedTerminalEndsItInGoodOrder) {
  const tools::StopOnSignal signals;
  std::raise(SIGPIPE);
  EXPECT_FALSE(tools::StopOnSignal::flag()) << "nobody reads the output any more";
  std::raise(SIGHUP);
  EXPECT_TRUE(tools::StopOnSignal::flag());
  std::raise(SIGHUP);  // a shell passes it on to its jobs once more
}

TEST(StopOnSignal, NohupKeepsTheHangupAway) {
  const auto before = std::signal(SIGHUP, SIG_IGN);
  {
    const tools::StopOnSignal signals;
    std::raise(SIGHUP);
    EXPECT_FALSE(tools::StopOnSignal::flag());
  }
  EXPECT_EQ(std::signal(SIGHUP, before), SIG_IGN);
}

}  // namespace
}  // namespace mixrig::test

// SPDX-License-Identifier: Apache-2.0
// The services of the package under the guest's systemd, which started mixrig.service at boot with
// a recording that is played as a rig, in /etc/mixrig. The watchdog is set to 8 s (before_boot).
#include <algorithm>
#include <filesystem>
#include <sstream>

#include <gtest/gtest.h>

#include "host/math/image_io/image_io.h"
#include "tests/board/bench.h"
#include "tests/board/screen.h"

namespace mixrig::board {
namespace {

namespace fs = std::filesystem;

constexpr auto kStart = 120s;
constexpr const char* kPage = "http://127.0.0.1:8437";

/// Waits for conditions that are checked by running a program; polls every 300 ms.
bool eventually(const std::function<bool()>& done, Duration timeout) {
  return wait_until(done, timeout, 300ms);
}
std::string shell(const std::string& command) {
  std::string text = run(command).text;
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}
std::string property(const std::string& unit, const std::string& name) {
  return shell("systemctl show -P " + name + " " + unit);
}
bool is_active(const std::string& unit = "mixrig") {
  return property(unit, "ActiveState") == "active";
}
int restarts() { return std::atoi(property("mixrig", "NRestarts").c_str()); }
std::string journal() { return shell("journalctl -u mixrig --no-pager -o cat"); }

class Service : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists("/run/systemd/system")) GTEST_SKIP() << "this boot has no systemd";
    ASSERT_TRUE(eventually([] { return is_active(); }, kStart)) << shell("systemctl status mixrig");
  }
  void TearDown() override {
    if (HasFailure()) std::printf("%s\n", journal().c_str());
  }
  /// Runs `spoil` with the service's process id, and expects that the service restarts by itself as
  /// another process.
  static void expect_restart(const std::string& spoil) {
    const std::string before = property("mixrig", "MainPID");
    const int restarted = restarts();
    ASSERT_EQ(run(spoil + " " + before).status, 0);
    EXPECT_TRUE(eventually([&] { return restarts() > restarted && is_active(); }, kStart));
    EXPECT_NE(property("mixrig", "MainPID"), before);
  }
};

TEST_F(Service, StartsAtBootCompositesAndServesThisMachineAlone) {
  EXPECT_EQ(restarts(), 0);
  EXPECT_EQ(shell("stat -c %U /proc/" + property("mixrig", "MainPID")), "mixrig");
  measured("%s", property("mixrig", "StatusText").c_str());
  EXPECT_NE(property("mixrig", "StatusText").find("composited"), std::string::npos);
  EXPECT_NE(shell(std::string("wget -q -O - ") + kPage + "/").find("<html"), std::string::npos);
  std::istringstream sockets(shell("ss -H -l -t -u -n | awk '{print $5}'"));
  int count = 0;
  for (std::string address; sockets >> address; ++count)
    EXPECT_TRUE(address.starts_with("127.") || address.starts_with("[::1]")) << address;
  EXPECT_GE(count, 1);
}

TEST_F(Service, ShowsTheCompositeOnTheScreen) {
  if (!has_screen()) GTEST_SKIP() << "this boot has no screen";
  Image<Rgb8> wanted;
  ASSERT_TRUE(
      image_io::read_rgb8("/host/takes/still/reference/composite/color/000002.png", wanted));
  std::size_t least = wanted.size().area();
  EXPECT_TRUE(eventually(
      [&] {
        const auto seen = screenshot();
        if (seen && seen->size() == wanted.size())
          least = std::min(least, differing(*seen, wanted, wanted.height()));
        return least == 0;
      },
      60s))
      << least << " pixels differ by more than 2 of 255";
}

TEST_F(Service, KilledItStartsAgain) { expect_restart("kill -KILL"); }

TEST_F(Service, HungItIsEndedByTheWatchdogAndStartsAgain) {
  expect_restart("kill -STOP");
  EXPECT_NE(journal().find("Watchdog timeout"), std::string::npos);
}

TEST_F(Service, AMissingSceneIsToldInOneLineAndNotTriedAgain) {
  for (const std::string file : {"scene.toml", "rig.toml"}) {
    ASSERT_EQ(run("cd /etc/mixrig && mv " + file + " " + file + ".away").status, 0);
    EXPECT_NE(run("systemctl restart mixrig").status, 0);
    EXPECT_FALSE(eventually([] { return property("mixrig", "ActiveState") != "failed"; }, 5s));
    EXPECT_EQ(property("mixrig", "ExecMainStatus"), "2");
    EXPECT_NE(journal().find("/etc/mixrig/" + file), std::string::npos);
    ASSERT_EQ(run("cd /etc/mixrig && mv " + file + ".away " + file).status, 0);
    ASSERT_EQ(run("systemctl start mixrig").status, 0);
  }
}

TEST_F(Service, ACameraThatIsMissingIsTriedUntilItIsThere) {
  ASSERT_EQ(run("cd /etc/mixrig && cp rig.toml rig.away && "
                "sed -i 's#uri = \"take.*color\"#uri = \"v4l2:/dev/video99\"#' rig.toml && "
                "sed -i 's#uri = \"take.*depth\"#uri = \"usb:1209:0001\"#' rig.toml")
                .status,
            0);
  (void)run("systemctl restart --no-block mixrig");
  EXPECT_TRUE(eventually([] { return restarts() >= 2; }, kStart));
  EXPECT_NE(journal().find("/dev/video99"), std::string::npos);
  ASSERT_EQ(run("mv /etc/mixrig/rig.away /etc/mixrig/rig.toml").status, 0);
  EXPECT_TRUE(eventually([] { return is_active(); }, kStart)) << "by itself";
}

TEST_F(Service, TheRecordingIsAServiceOfItsOwnAndTakesTheDevices) {
  ASSERT_EQ(run("systemctl start mixrig-record").status, 0);
  EXPECT_TRUE(is_active("mixrig-record"));
  EXPECT_TRUE(eventually([] { return !is_active(); }, 30s)) << "they exclude each other";
  eventually([] { return false; }, 3s);
  ASSERT_EQ(run("systemctl start mixrig").status, 0);
  EXPECT_FALSE(is_active("mixrig-record"));
  const Ran info = run("mixrig info /var/lib/mixrig/takes");
  EXPECT_EQ(info.status, 0) << info.text;
}

TEST_F(Service, WhatThePageSavesIsThereAfterARestart) {
  const std::string post = std::string("wget -q -O - --header 'Content-Type: application/json' ") +
                           "--post-data '{\"name\": \"added\", \"position_m\": [1, 1, 2.5], "
                           "\"intensity\": [1, 1, 1]}' " +
                           kPage + "/api/v1/lamps";
  const Ran added = run(post);
  EXPECT_EQ(added.status, 0) << added.text;
  EXPECT_TRUE(
      eventually([] { return run("grep -q added /etc/mixrig/scene.toml").status == 0; }, 20s));
  ASSERT_EQ(run("systemctl restart mixrig").status, 0);
  EXPECT_NE(shell(std::string("wget -q -O - ") + kPage + "/api/v1/lamps").find("added"),
            std::string::npos);
}

}  // namespace
}  // namespace mixrig::board

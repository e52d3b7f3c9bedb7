// SPDX-License-Identifier: Apache-2.0
// The sockets of a running `mixrig run`: nobody beyond this machine can reach any of them.
#include <set>

#include "tests/e2e/command.h"
#include "tests/support/child_process.h"
#include "tests/support/progress.h"

namespace mixrig::test {
namespace {

/// Inodes of the sockets that a process holds.
std::set<std::string> sockets_of(pid_t pid) {
  std::set<std::string> inodes;
  std::error_code code;
  for (const auto& entry :
       std::filesystem::directory_iterator("/proc/" + std::to_string(pid) + "/fd", code)) {
    const std::string target = std::filesystem::read_symlink(entry.path(), code).string();
    if (target.starts_with("socket:[")) inodes.insert(target.substr(8, target.size() - 9));
  }
  return inodes;
}

struct OpenPort {
  std::string table, address;  ///< hexadecimal, as the kernel's table has it
};

/// Ports of a process that take connections or datagrams.
std::vector<OpenPort> open_ports(pid_t pid) {
  constexpr const char* kListens = "0A";
  const auto inodes = sockets_of(pid);
  std::vector<OpenPort> ports;
  for (const std::string table : {"tcp", "tcp6", "udp", "udp6"}) {
    std::ifstream file("/proc/" + std::to_string(pid) + "/net/" + table);
    std::string line;
    std::getline(file, line);
    while (std::getline(file, line)) {
      std::istringstream words(line);
      std::string slot, local, remote, state, skip, inode;
      words >> slot >> local >> remote >> state;
      for (int i = 0; i < 5; ++i) words >> skip;
      words >> inode;
      const bool takes = table.starts_with("udp") || state == kListens;
      if (takes && inodes.contains(inode))
        ports.push_back({table, local.substr(0, local.find(':'))});
    }
  }
  return ports;
}

bool is_loopback(const OpenPort& port) {
  if (!port.table.ends_with('6')) return port.address.ends_with("7F");  // 127.x.x.x, little-endian
  return port.address == "00000000000000000000000001000000";
}

class OpenPorts : public CommandTest {
 protected:
  void SetUp() override {
    ASSERT_EQ(mixrig("studio --plain " + path("take") +
                     " --scenario walk --rig sr3000 --seed 7 --size 160x128 --frames 20"),
              0);
  }
  std::vector<std::string> run_words(std::vector<std::string> more) const {
    std::vector<std::string> words{
        MIXRIG_COMMAND, "run", path("take/scene.toml"), "--source", "take:" + path("take"),
        "--backend",    "cpu"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  std::string log() const {
    std::ifstream file(path("run.log"));
    return {std::istreambuf_iterator<char>(file), {}};
  }
};

TEST_F(OpenPorts, APageAndOscAreForThisMachineAlone) {
  ChildProcess run(run_words({"--page", "127.0.0.1:0", "--osc-in", "0"}), 300, path("run.log"));
  ASSERT_TRUE(comes_true([&] { return log().find("osc: 127.0.0.1:") != std::string::npos; }))
      << log();
  const auto ports = open_ports(run.program());
  EXPECT_EQ(ports.size(), 2U) << "the page and OSC";
  for (const OpenPort& port : ports)
    EXPECT_TRUE(is_loopback(port)) << port.table << " " << port.address;
}

/// Streams, poses and a window are sent from ports, and none of them is open to others.
TEST_F(OpenPorts, WhatIsSentOpensNoPortToOthers) {
  std::ofstream(path("take/scene.toml"), std::ios::app)
      << "\n[[pose_out]]\nprotocol = \"freed\"\nudp = \"127.0.0.1:9\"\n"
         "[[pose_out]]\nprotocol = \"opentrackio\"\nudp = \"127.0.0.1:9\"\n"
         "[[stream_out]]\nuri = \"rtp://127.0.0.1:9\"\n";
  ::setenv("SDL_VIDEODRIVER", "dummy", 1);
  ChildProcess run(run_words({"--page", "127.0.0.1:0", "--osc-in", "0", "--view", "--stream",
                              "srt://127.0.0.1:0?mode=listener"}),
                   300, path("run.log"));
  ::unsetenv("SDL_VIDEODRIVER");
  const auto recorded = [&] {  // frames are composited: all sinks are open
    const auto ports = open_ports(run.program());
    return ports.size() >= 4 ? ports : std::vector<OpenPort>{};
  };
  ASSERT_TRUE(comes_true([&] { return !recorded().empty(); })) << log();
  for (const OpenPort& port : open_ports(run.program()))
    EXPECT_TRUE(is_loopback(port)) << port.table << " " << port.address;
}

TEST_F(OpenPorts, WhoAsksForItIsReachable) {
  ChildProcess run(run_words({"--page", "0.0.0.0:0"}), 300, path("run.log"));
  ASSERT_TRUE(comes_true([&] { return log().find("?token=") != std::string::npos; })) << log();
  const auto ports = open_ports(run.program());
  ASSERT_EQ(ports.size(), 1U);
  EXPECT_FALSE(is_loopback(ports[0])) << "else the test could not fail";
}

TEST_F(OpenPorts, ARunWithoutAPageHasNone) {
  ChildProcess run(run_words({"--out", path("out")}), 300, path("run.log"));
  int looks = 0;
  ASSERT_TRUE(comes_true([&] {  // until it has ended by itself
    const pid_t pid = run.program();
    if (pid == 0) return looks > 0;
    ++looks;
    EXPECT_TRUE(open_ports(pid).empty());
    return false;
  }));
  EXPECT_EQ(run.wait(), 0) << log();
}

}  // namespace
}  // namespace mixrig::test

// SPDX-License-Identifier: Apache-2.0
// The sockets of a running `mixrig run` must not be reachable from other machines.
#include <algorithm>
#include <set>

#include "tests/e2e/command.h"
#include "tests/support/child_process.h"
#include "tests/support/progress.h"
#include "tests/support/udp_listener.h"

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
  std::string table, address;  ///< hexadecimal, as in the kernel's table
  int port = 0;
  auto operator<=>(const OpenPort&) const = default;
};

/// Ports of a process that accept connections or datagrams.
std::set<OpenPort> open_ports(pid_t pid) {
  constexpr const char* kListens = "0A";
  const auto inodes = sockets_of(pid);
  std::set<OpenPort> ports;
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
      if (!takes || !inodes.contains(inode)) continue;
      const std::size_t colon = local.find(':');
      ports.insert(
          {table, local.substr(0, colon), std::stoi(local.substr(colon + 1), nullptr, 16)});
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
    ASSERT_EQ(
        studio("take", "--plain --scenario walk --rig sr3000 --seed 7 --size 160x128 --frames 20"),
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

/// Streams, poses and a window are sent from ports of which none is open to other machines.
TEST_F(OpenPorts, WhatIsSentOpensNoPortToOthers) {
  std::ofstream(path("take/scene.toml"), std::ios::app)
      << "\n[[pose_out]]\nprotocol = \"freed\"\nudp = \"127.0.0.1:9\"\n"
         "[[pose_out]]\nprotocol = \"opentrackio\"\nudp = \"127.0.0.1:9\"\n"
         "[[stream_out]]\nuri = \"rtp://127.0.0.1:9\"\n";
  const std::string stream = UdpListener().address();  // a free port
  ::setenv("SDL_VIDEODRIVER", "dummy", 1);
  ChildProcess run(run_words({"--page", "127.0.0.1:0", "--osc-in", "0", "--view", "--stream",
                              "srt://" + stream + "?mode=listener"}),
                   300, path("run.log"));
  ::unsetenv("SDL_VIDEODRIVER");
  constexpr std::size_t kPorts = 6;  // page, OSC, two poses, RTP, SRT
  const int stream_port = std::stoi(stream.substr(stream.find(':') + 1));
  std::set<OpenPort> ports;
  bool began = false;
  ASSERT_TRUE(comes_true([&] {  // or until it has ended, which is wrong: it plays until stopped
    const pid_t pid = run.program();
    if (pid == 0) return began;
    began = true;
    ports = open_ports(pid);
    const auto is_stream = [&](const OpenPort& port) { return port.port == stream_port; };
    return ports.size() >= kPorts && std::any_of(ports.begin(), ports.end(), is_stream);
  })) << log();
  EXPECT_EQ(ports.size(), kPorts) << log();
  for (const OpenPort& port : ports)
    EXPECT_TRUE(is_loopback(port)) << port.table << " " << port.address << ":" << port.port;
}

TEST_F(OpenPorts, WhoAsksForItIsReachable) {
  ChildProcess run(run_words({"--page", "0.0.0.0:0"}), 300, path("run.log"));
  ASSERT_TRUE(comes_true([&] { return log().find("?token=") != std::string::npos; })) << log();
  const auto ports = open_ports(run.program());
  ASSERT_EQ(ports.size(), 1U);
  EXPECT_FALSE(is_loopback(*ports.begin())) << "else the test could not fail";
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

// SPDX-License-Identifier: Apache-2.0
// Pan-tilt unit and trigger controller on kernel serial ports: USB lines of this process, and the
// machine's ports with a peer on the host where MIXRIG_BOARD_PTU and MIXRIG_BOARD_MCU name them.
#include <cstdlib>
#include <random>

#include "host/capture/live/rig/devices.h"
#include "tests/board/bench.h"
#include "tests/board/nodes.h"
#include "tests/board/trigger_peer.h"

namespace mixrig::board {
namespace {

SystemClock g_clock;
live::DeviceOpener g_opener(g_clock);

struct Line {
  explicit Line(SerialPeer& peer) : device("serial line", peer) {}
  AcmDevice device;
  VhciPort port{2, device};
  bool plug() { return plug_serial(port, "/dev/ttyACM0"); }
};

/// Random commands of all kinds; counts answers that do not match the unit's state.
void command(device::PanTilt& head, int count, std::function<std::array<long, 2>()> truth) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> share(-0.9, 0.9);
  const auto info = head.info();
  int wrong = 0;
  device::PanTiltAngles target{};
  for (int i = 0; i < count; ++i) {
    if (i % 5 == 0) {
      target = {share(random) * info.maximum.pan_rad, share(random) * info.maximum.tilt_rad};
      const auto moved = head.move_to(target);
      ASSERT_TRUE(moved) << to_line(moved.error());
      continue;
    }
    const auto before = truth ? truth() : std::array<long, 2>{};
    const auto sample = head.sample();
    ASSERT_TRUE(sample) << to_line(sample.error());
    if (!truth) continue;
    const auto after = truth();
    const double steps[] = {sample->angles.pan_rad / info.resolution.pan_rad,
                            sample->angles.tilt_rad / info.resolution.tilt_rad};
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const auto [low, high] = std::minmax(before[axis], after[axis]);
      if (steps[axis] < static_cast<double>(low) - 1.01 ||
          steps[axis] > static_cast<double>(high) + 1.01)
        ++wrong;
    }
  }
  EXPECT_EQ(wrong, 0) << "answers that belong to another command";
}

TEST(Ptu, TenThousandCommandsAreAnsweredCorrectlyWithLimitReportsInTheirReplies) {
  PtuPeer peer;
  Line line(peer);
  ASSERT_TRUE(line.plug());
  auto head = g_opener.pan_tilt("flir-ptu:/dev/ttyACM0");
  ASSERT_TRUE(head) << to_line(head.error());
  // Few, since each one inside a reply costs 60 ms of silence; hal_device_test asks with 0.2.
  peer.set_faults({.limit_report_share = 0.02});
  command(**head, 5000, [&] { return peer.position(g_clock.now()); });
  const auto health = (*head)->health();
  measured(
      "%llu commands, %llu limit reports injected, %llu counted, %llu repeated, %llu noise bytes",
      static_cast<unsigned long long>(health.commands),
      static_cast<unsigned long long>(peer.limit_reports()),
      static_cast<unsigned long long>(health.limit_hits),
      static_cast<unsigned long long>(health.timeouts),
      static_cast<unsigned long long>(health.noise_bytes));
  EXPECT_GE(health.commands, 10000U);
  EXPECT_GE(peer.limit_reports(), 150U);
  EXPECT_EQ(health.limit_hits, peer.limit_reports());
}

TEST(Ptu, NoAnswerIsReportedAndItAnswersAgain) {
  PtuPeer peer;
  Line line(peer);
  ASSERT_TRUE(line.plug());
  auto head = g_opener.pan_tilt("flir-ptu:/dev/ttyACM0");
  ASSERT_TRUE(head) << to_line(head.error());
  peer.set_faults({.silent = true});
  const auto nothing = (*head)->sample();
  ASSERT_FALSE(nothing);
  EXPECT_EQ(nothing.error().code, ErrorCode::kTimeout) << to_line(nothing.error());
  peer.set_faults({});
  EXPECT_TRUE((*head)->sample());
}

TEST(Ptu, UnpluggingIsAnErrorAndNoHang) {
  PtuPeer peer;
  Line line(peer);
  ASSERT_TRUE(line.plug());
  auto head = g_opener.pan_tilt("flir-ptu:/dev/ttyACM0");
  ASSERT_TRUE(head) << to_line(head.error());
  line.port.unplug();
  EXPECT_FALSE((*head)->sample());
}

TEST(Ptu, AnswersOnAPortOfTheMachine) {
  const char* port = std::getenv("MIXRIG_BOARD_PTU");
  if (port == nullptr) GTEST_SKIP() << "no emulated unit on the host";
  auto head = g_opener.pan_tilt(std::string("flir-ptu:") + port);
  ASSERT_TRUE(head) << to_line(head.error());
  command(**head, 50, {});
  measured("50 commands on %s, %llu repeated", port,
           static_cast<unsigned long long>((*head)->health().timeouts));
}

void run_trigger(const std::string& uri, bool exact) {
  auto trigger = g_opener.trigger(uri);
  ASSERT_TRUE(trigger) << to_line(trigger.error());
  ASSERT_TRUE((*trigger)->configure(0, {.divider = 4, .phase = 0ms, .width = 1ms}));
  ASSERT_TRUE((*trigger)->start());
  std::vector<device::TriggerTick> ticks;
  const HostTime end = g_clock.now() + kTimeout;
  while (ticks.size() < 200 && g_clock.now() < end) {
    std::array<device::TriggerTick, 16> some;
    const auto count = (*trigger)->read_ticks(some, 50ms);
    ASSERT_TRUE(count) << to_line(count.error());
    ticks.insert(ticks.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(*count));
  }
  ASSERT_TRUE((*trigger)->stop());
  ASSERT_GE(ticks.size(), 200U);
  for (std::size_t i = 0; i < 200 && exact; ++i) {
    EXPECT_EQ(ticks[i].tick, i);
    EXPECT_EQ(ticks[i].channels, i % 4 == 0 ? 1U : 0U);
    EXPECT_EQ(ticks[i].at - ticks[0].at, static_cast<long>(i) * Duration(10ms));
  }
  measured("%zu ticks on %s, the last one is number %llu", ticks.size(), uri.c_str(),
           static_cast<unsigned long long>(ticks.back().tick));
}

TEST(Mcu, FirmwareReportsEveryTickAndFiresItsLine) {
  std::vector<std::uint32_t> edges;
  std::mutex mutex;
  TriggerPeer peer(120, [&](int line, std::uint32_t tick) {
    const std::lock_guard lock(mutex);
    if (line == 0) edges.push_back(tick);
  });
  Line line(peer);
  ASSERT_TRUE(line.plug());
  run_trigger("mcu:/dev/ttyACM0", true);
  const std::lock_guard lock(mutex);
  ASSERT_GE(edges.size(), 50U);
  for (std::size_t i = 1; i < edges.size(); ++i) EXPECT_EQ(edges[i] - edges[i - 1], 4U);
}

TEST(Mcu, AResetIsReportedAndRecoveredFrom) {
  TriggerPeer peer(0, [](int, std::uint32_t) {});
  Line line(peer);
  ASSERT_TRUE(line.plug());
  auto trigger = g_opener.trigger("mcu:/dev/ttyACM0");
  ASSERT_TRUE(trigger) << to_line(trigger.error());
  ASSERT_TRUE((*trigger)->configure(0, {.divider = 4, .phase = 0ms, .width = 1ms}));
  ASSERT_TRUE((*trigger)->start());
  peer.reset();
  const HostTime pressed = g_clock.now();
  ASSERT_TRUE(wait_until([&] {
    const auto status = (*trigger)->status();
    return status && status->state == device::TriggerState::kIdle;
  }));
  EXPECT_EQ((*trigger)->info().reset_cause, "reset pin");
  ASSERT_TRUE((*trigger)->configure(0, {.divider = 4, .phase = 0ms, .width = 1ms}));
  ASSERT_TRUE((*trigger)->start());
  EXPECT_LT(g_clock.now() - pressed, kRecovery);
}

TEST(Mcu, AnswersOnAPortOfTheMachine) {
  const char* port = std::getenv("MIXRIG_BOARD_MCU");
  if (port == nullptr) GTEST_SKIP() << "no trigger firmware on the host";
  run_trigger(std::string("mcu:") + port, false);
}

}  // namespace
}  // namespace mixrig::board

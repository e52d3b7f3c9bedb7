// SPDX-License-Identifier: Apache-2.0
// The contract of TriggerMaster on the fake, on the controller's firmware on an emulated board, and
// on software that switches lines.
#include "tests/unit/hal_device/trigger_contract.h"

#include <mutex>

#include "hal/fake/emulated_board.h"
#include "hal/fake/fake_trigger.h"
#include "hal/wire/trigger/mcu_trigger.h"
#include "hal/wire/trigger/software_trigger.h"
#include "tests/support/make_image.h"

namespace mixrig::test {
namespace {

TriggerUnderTest fake_trigger() {
  auto clock = std::make_shared<ManualClock>();
  auto trigger = std::make_unique<fake::FakeTrigger>(*clock);
  auto* raw = trigger.get();
  return {clock, std::move(trigger), [clock, raw] {
            clock->advance(std::chrono::milliseconds(10));
            raw->tick();
          }};
}

TriggerUnderTest make_mcu() {
  struct Bench {
    ManualClock clock;
    fake::EmulatedBoard board;
  };
  auto bench = std::make_shared<Bench>();
  bench->board.flash().load(device::make_image(2048, 1));
  bench->board.power_cycle(false);
  auto stream = std::make_unique<fake::BoardStream>(bench->board, bench->clock);
  auto opened = device::McuTrigger::open(std::move(stream), bench->clock, "test");
  if (!opened) return {};
  return {bench, *std::move(opened)};
}

struct LineLog {
  std::mutex mutex;
  std::vector<std::pair<int, bool>> changes;
  bool broken = false;
};

class LoggedOutputs final : public device::LineOutputs {
 public:
  explicit LoggedOutputs(LineLog& log) : log_(log) {}
  int count() const override { return 4; }
  Result<void> drive(int line, bool high) override {
    const std::lock_guard lock(log_.mutex);
    if (log_.broken) return Error{ErrorCode::kDevice, "line is gone"};
    log_.changes.emplace_back(line, high);
    return {};
  }

 private:
  LineLog& log_;
};

struct SoftwareBench {
  SystemClock clock;
  LineLog log;
  std::unique_ptr<device::TriggerMaster> trigger = std::make_unique<device::SoftwareTrigger>(
      std::make_unique<LoggedOutputs>(log), clock, "gpiod:test");
};

TriggerUnderTest make_software() {
  auto bench = std::make_shared<SoftwareBench>();
  return {bench, std::move(bench->trigger)};
}

INSTANTIATE_TEST_SUITE_P(All, TriggerContract,
                         ::testing::Values(TriggerMaker{"fake", fake_trigger},
                                           TriggerMaker{"mcu_on_emulated_board", make_mcu},
                                           TriggerMaker{"software", make_software}),
                         [](const auto& maker) { return maker.param.name; });

/// Waits until `count` ticks were reported.
void wait_for(device::TriggerMaster& trigger, std::size_t count) {
  std::array<device::TriggerTick, 8> some;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  for (std::size_t got = 0; got < count && std::chrono::steady_clock::now() < end;) {
    got += *trigger.read_ticks(some, std::chrono::milliseconds(100));
  }
}

TEST(SoftwareTriggerLines, AreInactiveBeforeAndAfterARunAndSwitchInOrder) {
  SoftwareBench bench;
  const auto ms = std::chrono::milliseconds(1);
  ASSERT_TRUE(bench.trigger->configure(0, {1, {}, 2 * ms, false}));
  ASSERT_TRUE(bench.trigger->configure(1, {2, 3 * ms, 2 * ms, true}));
  ASSERT_TRUE(bench.trigger->start());
  wait_for(*bench.trigger, 10);
  ASSERT_TRUE(bench.trigger->stop());
  const auto& changes = bench.log.changes;
  ASSERT_GT(changes.size(), 4U + 20U);
  const std::vector<std::pair<int, bool>> rest = {{0, false}, {1, true}, {2, false}, {3, false}};
  EXPECT_TRUE(std::equal(rest.begin(), rest.end(), changes.begin()));
  EXPECT_TRUE(std::equal(rest.begin(), rest.end(), changes.end() - 4));
  const std::vector<std::pair<int, bool>> period = {{0, true}, {0, false}, {1, false},
                                                    {1, true}, {0, true},  {0, false}};
  for (std::size_t i = 4; i + 4 < changes.size(); ++i) {
    EXPECT_EQ(changes[i], period[(i - 4) % period.size()]) << i;
  }
}

TEST(SoftwareTriggerLines, AFailingLineIsCountedWhileRunningAndRefusedAtStart) {
  SoftwareBench bench;
  ASSERT_TRUE(bench.trigger->configure(0, {1, {}, std::chrono::milliseconds(2), false}));
  ASSERT_TRUE(bench.trigger->start());
  {
    const std::lock_guard lock(bench.log.mutex);
    bench.log.broken = true;
  }
  wait_for(*bench.trigger, 5);
  const auto status = bench.trigger->status();
  EXPECT_EQ(status->faults[1].name, "line_failed");
  EXPECT_GT(status->faults[1].count, 0U);
  EXPECT_FALSE(bench.trigger->stop());
  EXPECT_FALSE(bench.trigger->start());
}

}  // namespace
}  // namespace mixrig::test

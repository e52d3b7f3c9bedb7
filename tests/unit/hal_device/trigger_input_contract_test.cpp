// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/hal_device/trigger_input_contract.h"

#include "hal/fake/fake_trigger_input.h"

namespace mixrig::test {
namespace {

TriggerInputUnderTest fake_trigger_input() {
  auto clock = std::make_shared<ManualClock>();
  auto input = std::make_unique<fake::FakeTriggerInput>(*clock);
  auto* raw = input.get();
  return {std::move(input),
          [clock, raw](int count) {
            for (int i = 0; i < count; ++i) {
              clock->advance(std::chrono::milliseconds(10));
              raw->edge();
            }
          },
          clock};
}

INSTANTIATE_TEST_SUITE_P(Fake, TriggerInputContract,
                         ::testing::Values(TriggerInputMaker{"fake", fake_trigger_input}),
                         [](const auto& maker) { return maker.param.name; });

}  // namespace
}  // namespace mixrig::test

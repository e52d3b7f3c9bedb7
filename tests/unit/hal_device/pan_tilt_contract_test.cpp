// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/hal_device/pan_tilt_contract.h"

#include "hal/fake/fake_pan_tilt.h"
#include "hal/fake/flir_ptu_emulator.h"
#include "hal/wire/pan_tilt/flir_ptu.h"

namespace mixrig::test {
namespace {

PanTiltUnderTest fake_pan_tilt() {
  auto clock = std::make_shared<ManualClock>();
  auto* raw = clock.get();
  return {std::make_unique<fake::FakePanTilt>(*clock), raw, std::move(clock)};
}

/// The ASCII protocol, down to its bytes.
PanTiltUnderTest make_flir() {
  struct Bench {
    ManualClock clock;
    fake::FlirPtuEmulator unit{7};
  };
  auto bench = std::make_shared<Bench>();
  auto head = device::FlirPtu::open(std::make_unique<fake::FlirPtuLine>(bench->unit, bench->clock),
                                    bench->clock, "flir-ptu:emulated");
  if (!head) return {};
  auto* clock = &bench->clock;
  return {*std::move(head), clock, std::move(bench)};
}

INSTANTIATE_TEST_SUITE_P(All, PanTiltContract,
                         ::testing::Values(PanTiltMaker{"fake", fake_pan_tilt},
                                           PanTiltMaker{"flir", make_flir}),
                         [](const auto& maker) { return maker.param.name; });

}  // namespace
}  // namespace mixrig::test

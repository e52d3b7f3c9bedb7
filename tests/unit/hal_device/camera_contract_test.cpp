// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/hal_device/camera_contract.h"

#include "hal/fake/fake_camera.h"

namespace mixrig::test {
namespace {

device::CameraInfo small_camera() {
  return {.uri = "fake:camera",
          .model = "fake",
          .size = {8, 4},
          .format = device::PixelFormat::kGray8,
          .stamp_clock = device::StampClock::kHost,
          .controls = {{device::CameraControl::kExposure, 0.0001, 0.04, 0.0001}}};
}

CameraUnderTest fake_camera() {
  static ManualClock clock;
  auto camera = std::make_unique<fake::FakeCamera>(clock, small_camera());
  auto* raw = camera.get();
  return {std::move(camera), [raw](int count) {
            for (int i = 0; i < count; ++i) {
              clock.advance(std::chrono::milliseconds(40));
              raw->emit();
            }
          }};
}

INSTANTIATE_TEST_SUITE_P(Fake, CameraContract, ::testing::Values(CameraMaker{"fake", fake_camera}),
                         [](const auto& maker) { return maker.param.name; });

}  // namespace
}  // namespace mixrig::test

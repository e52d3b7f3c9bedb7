// SPDX-License-Identifier: Apache-2.0
// What every camera promises, held by the v4l2 driver on vivid and on uvcvideo.
#include "hal/linux/v4l2_camera.h"
#include "tests/board/bench.h"
#include "tests/board/nodes.h"
#include "tests/unit/hal_device/camera_contract.h"

namespace mixrig::test {
namespace {

SystemClock g_clock;

/// `bench` lives as long as the camera does.
CameraUnderTest make(const std::string& node, std::shared_ptr<board::UvcBench> bench) {
  auto camera = device::V4l2Camera::open(
      node, {.size = {320, 180}, .format = device::PixelFormat::kYuyv, .rate_hz = 30}, g_clock);
  if (!camera) {
    std::fprintf(stderr, "%s\n", to_line(camera.error()).c_str());
    return {};
  }
  auto* raw = camera->get();
  return {*std::move(camera), [raw, bench](int count) {
            const auto wanted = raw->health().frames + static_cast<std::uint64_t>(count);
            board::wait_until([&] {
              return raw->health().state != device::DeviceState::kStreaming ||
                     raw->health().frames >= wanted;
            });
          }};
}

CameraUnderTest make_vivid() { return make("/dev/video0", nullptr); }

CameraUnderTest make_uvc() {
  auto bench = std::make_shared<board::UvcBench>();
  return bench->plug() ? make(bench->node, bench) : CameraUnderTest{};
}

INSTANTIATE_TEST_SUITE_P(OnBoard, CameraContract,
                         ::testing::Values(CameraMaker{"vivid", make_vivid},
                                           CameraMaker{"uvc", make_uvc}),
                         [](const auto& maker) { return maker.param.name; });

}  // namespace
}  // namespace mixrig::test

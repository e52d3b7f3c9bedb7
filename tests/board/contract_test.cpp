// SPDX-License-Identifier: Apache-2.0
// The contracts of all devices, tested with the drivers on kernel devices: v4l2 on vivid and
// uvcvideo, gpiod on gpio-sim, usb on usbfs, mcu and flir-ptu on cdc_acm.
#include "hal/linux/gpiod/gpiod_lines.h"
#include "hal/linux/tof_usb_camera.h"
#include "hal/linux/v4l2/v4l2_camera.h"
#include "host/capture/live/rig/devices.h"
#include "tests/board/bench.h"
#include "tests/board/nodes.h"
#include "tests/board/sim_chip.h"
#include "tests/board/tof_device.h"
#include "tests/board/trigger_peer.h"
#include "tests/unit/hal_device/camera_contract.h"
#include "tests/unit/hal_device/depth_camera_contract.h"
#include "tests/unit/hal_device/pan_tilt_contract.h"
#include "tests/unit/hal_device/trigger_contract.h"
#include "tests/unit/hal_device/trigger_input_contract.h"

namespace mixrig::test {
namespace {

SystemClock g_clock;

/// A camera under test; `bench` lives as long as the camera.
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

TriggerInputUnderTest make_line() {
  auto chip = std::make_shared<board::SimChip>();
  auto input = device::open_gpiod_input(chip->name() + "/5");
  if (!input) return {};
  auto* raw = input->get();
  return {*std::move(input),
          [chip, raw](int count) {
            const auto wanted = raw->health().frames + static_cast<std::uint64_t>(count);
            for (int i = 0; i < count; ++i)
              for (const bool high : {true, false}) {
                chip->pull(5, high);
                g_clock.sleep_until(g_clock.now() + std::chrono::milliseconds(2));
              }
            board::wait_until([&] {
              return raw->health().state != device::DeviceState::kStreaming ||
                     raw->health().frames >= wanted;
            });
          },
          chip};
}

INSTANTIATE_TEST_SUITE_P(OnBoard, TriggerInputContract,
                         ::testing::Values(TriggerInputMaker{"gpio_sim", make_line}),
                         [](const auto& maker) { return maker.param.name; });

TriggerUnderTest make_lines() {
  auto chip = std::make_shared<board::SimChip>();
  auto trigger = device::open_gpiod_trigger(chip->name() + "/0,1,2", g_clock);
  if (!trigger) return {};
  return {chip, *std::move(trigger)};
}

/// A device of this process behind a serial line of the kernel.
template <typename Peer>
struct SerialBench {
  template <typename... Arguments>
  explicit SerialBench(Arguments&&... arguments) : peer(std::forward<Arguments>(arguments)...) {}
  Peer peer;
  board::AcmDevice line{"serial line", peer};
  board::VhciPort port{2, line};
};

TriggerUnderTest make_firmware() {
  auto bench = std::make_shared<SerialBench<board::TriggerPeer>>(0.0, [](int, std::uint32_t) {});
  if (!board::plug_serial(bench->port, "/dev/ttyACM0")) return {};
  auto trigger = live::DeviceOpener(g_clock).trigger("mcu:/dev/ttyACM0");
  if (!trigger) return {};
  return {bench, *std::move(trigger)};
}

INSTANTIATE_TEST_SUITE_P(OnBoard, TriggerContract,
                         ::testing::Values(TriggerMaker{"gpio_sim", make_lines},
                                           TriggerMaker{"firmware_on_cdc_acm", make_firmware}),
                         [](const auto& maker) { return maker.param.name; });

PanTiltUnderTest make_head() {
  auto bench = std::make_shared<SerialBench<board::PtuPeer>>();
  if (!board::plug_serial(bench->port, "/dev/ttyACM0")) return {};
  auto head = live::DeviceOpener(g_clock).pan_tilt("flir-ptu:/dev/ttyACM0");
  if (!head) return {};
  return {*std::move(head), &g_clock, bench};
}

INSTANTIATE_TEST_SUITE_P(OnBoard, PanTiltContract,
                         ::testing::Values(PanTiltMaker{"flir_ptu_on_cdc_acm", make_head}),
                         [](const auto& maker) { return maker.param.name; });

DepthCameraUnderTest make_tof() {
  struct Bench {
    board::TofDevice device{{160, 120}, 25};
    board::VhciPort port{1, device};
  };
  auto bench = std::make_shared<Bench>();
  if (!bench->port.plug()) return {};
  std::unique_ptr<device::DepthCamera> camera;
  board::wait_until([&] {
    auto opened = device::open_tof_usb("1209:0001", g_clock);
    if (opened) camera = *std::move(opened);
    return camera != nullptr;
  });
  auto* raw = camera.get();
  return {std::move(camera),
          [raw](int count) {
            const auto wanted = raw->health().frames + static_cast<std::uint64_t>(count);
            board::wait_until([&] {
              return raw->health().state != device::DeviceState::kStreaming ||
                     raw->health().frames >= wanted;
            });
          },
          bench};
}

INSTANTIATE_TEST_SUITE_P(OnBoard, DepthCameraContract,
                         ::testing::Values(DepthCameraMaker{"tof_on_usbfs", make_tof}),
                         [](const auto& maker) { return maker.param.name; });

}  // namespace
}  // namespace mixrig::test

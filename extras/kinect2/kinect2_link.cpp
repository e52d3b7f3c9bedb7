// SPDX-License-Identifier: Apache-2.0
// The order of commands and requests: facts of libfreenect2 (at fd64c5d, libfreenect2.cpp and
// usb_control.cpp).
#include "extras/kinect2/kinect2_link.h"

#include <array>
#include <optional>
#include <span>

namespace mixrig::device {
namespace {

constexpr std::uint8_t kCommandOut = 0x02, kCommandIn = 0x81;
constexpr int kInfraredInterface = 1, kStatusTries = 50;
constexpr Duration kStatusWait = std::chrono::milliseconds(100);
constexpr std::uint32_t kMostPage = 0x1C0000;
// USB 3.1: SET_ISOCH_DELAY of 40 ns; SET_FEATURE U1 and U2; FUNCTION_SUSPEND of interface 0.
constexpr UsbRequest kIsochronousDelay{0, 49, 40, 0}, kEnableU1{0, 3, 48, 0},
    kEnableU2{0, 3, 49, 0};
constexpr UsbRequest kVideoOn{1, 3, 0, 0}, kVideoOff{1, 3, 0, 0x0300};

Kinect2Request page(Kinect2Page number, std::uint32_t most, std::uint32_t least) {
  return {Kinect2Command::kPage, {static_cast<std::uint32_t>(number)}, 1, most, least};
}
Kinect2Request set_mode(std::uint32_t on, std::uint32_t value = 0) {
  return {Kinect2Command::kSetMode, {on, value}, 4};
}
const Kinect2Request kReadStatus{Kinect2Command::kStatus, {0x090000}, 1, 4, 4};

}  // namespace

/// Sends a command and reads its answer and its completion.
Result<std::vector<std::uint8_t>> Kinect2Link::ask(const Kinect2Request& request) {
  const std::uint32_t sequence = sequence_++;
  MIXRIG_TRY(usb_.write(kCommandOut, pack_kinect2_request(request, sequence)));
  const auto failed = [&](const char* what) {
    return Error{ErrorCode::kDevice, uri_ + ": command " +
                                         std::to_string(static_cast<int>(request.command)) + " " +
                                         what + ": plug the camera in again"};
  };
  std::vector<std::uint8_t> answer;
  if (request.most_answer > 0) {
    answer.resize(request.most_answer);
    MIXRIG_ASSIGN(const std::size_t got, usb_.read(kCommandIn, answer));
    answer.resize(got);
    if (parse_kinect2_complete(answer) || got < request.least_answer)
      return failed("was answered with too little");
  }
  std::array<std::uint8_t, 16> complete{};
  MIXRIG_ASSIGN(const std::size_t got, usb_.read(kCommandIn, complete));
  const auto done = parse_kinect2_complete(std::span<const std::uint8_t>(complete).first(got));
  if (!done || *done != sequence) return failed("was not completed");
  return answer;
}

Result<Kinect2Description> Kinect2Link::describe() {
  Kinect2Description told;
  MIXRIG_TRY(usb_.open());
  MIXRIG_TRY(usb_.request(kIsochronousDelay));
  MIXRIG_TRY(usb_.set_alternate(kInfraredInterface, 0));
  MIXRIG_TRY(usb_.request(kEnableU1));
  MIXRIG_TRY(usb_.request(kEnableU2));
  MIXRIG_TRY(usb_.request(kVideoOn));
  MIXRIG_ASSIGN(auto bytes, ask({Kinect2Command::kFirmware, {}, 0, 0x200, 60}));
  MIXRIG_ASSIGN(told.firmware, parse_kinect2_firmware(bytes));
  MIXRIG_ASSIGN(bytes, ask(page(Kinect2Page::kSerial, 0x80, 2)));
  MIXRIG_ASSIGN(told.serial, parse_kinect2_serial(bytes));
  MIXRIG_ASSIGN(bytes, ask(page(Kinect2Page::kInfrared, kMostPage, 92)));
  MIXRIG_ASSIGN(told.infrared, parse_kinect2_infrared(bytes));
  MIXRIG_ASSIGN(bytes, ask(page(Kinect2Page::kPhaseOffsets, kMostPage, 1302572)));
  MIXRIG_ASSIGN(told.offsets, parse_kinect2_offsets(bytes));
  MIXRIG_TRY(usb_.request(kVideoOff));
  return told;
}

Result<void> Kinect2Link::begin() {
  MIXRIG_TRY(usb_.open());
  MIXRIG_TRY(usb_.request(kVideoOn));
  MIXRIG_TRY(ask(set_mode(1, 0x00640064)));
  MIXRIG_TRY(ask(set_mode(0)));
  bool ready = false;
  for (int i = 0; i < kStatusTries && !ready; ++i) {
    MIXRIG_ASSIGN(const auto bytes, ask(kReadStatus));
    MIXRIG_ASSIGN(const std::uint32_t status, parse_kinect2_status(bytes));
    ready = (status & 1) != 0;
    if (!ready) clock_.sleep_until(clock_.now() + kStatusWait);
  }
  if (!ready)
    return Error{ErrorCode::kDevice, uri_ + ": does not get ready: check its power supply"};
  MIXRIG_TRY(ask({Kinect2Command::kInitStreams}));
  MIXRIG_TRY(usb_.set_alternate(kInfraredInterface, 1));
  MIXRIG_TRY(ask(kReadStatus));
  MIXRIG_TRY(ask({Kinect2Command::kSetStreaming, {1}, 1}));
  return {};
}

void Kinect2Link::end() {
  (void)usb_.set_alternate(kInfraredInterface, 0);
  for (const Kinect2Request& request :
       {set_mode(1, 0x00640064), set_mode(0), Kinect2Request{Kinect2Command::kStop},
        Kinect2Request{Kinect2Command::kSetStreaming, {0}, 1}, set_mode(1), set_mode(0)})
    if (!ask(request)) break;
  (void)usb_.request(kVideoOff);
}

}  // namespace mixrig::device

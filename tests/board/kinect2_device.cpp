// SPDX-License-Identifier: Apache-2.0
#include "tests/board/kinect2_device.h"

#include <algorithm>
#include <utility>

namespace mixrig::board {
namespace {

constexpr int kCommandOut = 2, kCommandIn = 1, kColorIn = 3, kInfraredIn = 4,
              kInfraredInterface = 1;
constexpr std::uint8_t kBulk = 2, kIsochronous = 1;

using Bytes = std::vector<std::uint8_t>;

void put_interface(Bytes& to, std::uint8_t number, std::uint8_t setting, std::uint8_t endpoints) {
  to.insert(to.end(), {9, 4, number, setting, endpoints, 0xFF, 0, 0, 0});
}

/// Appends an endpoint and its SuperSpeed companion. `bytes`: per service interval, for isochronous
/// endpoints.
void put_endpoint(Bytes& to, std::uint8_t address, std::uint8_t kind, std::uint8_t burst,
                  std::uint8_t mult, std::uint16_t bytes) {
  const std::uint8_t interval = kind == kIsochronous ? 1 : 0;
  to.insert(to.end(), {7, 5, address, kind, 0x00, 0x04, interval});
  to.insert(to.end(), {6, 0x30, burst, mult, static_cast<std::uint8_t>(bytes),
                       static_cast<std::uint8_t>(bytes >> 8)});
}

}  // namespace

Kinect2Device::Kinect2Device(device::EmulatedKinect2::Answers answers)
    : camera_(std::move(answers)), pipes_(camera_.pipes()), answer_(std::size_t{2} << 20) {
  descriptors_.speed = UsbSpeed::kSuper;
  descriptors_.device = {18,   1,    0x00, 0x03, 0,    0, 0, 9, 0x5E,
                         0x04, 0xC4, 0x02, 0x00, 0x01, 1, 2, 3, 1};
  Bytes body;
  put_interface(body, 0, 0, 3);
  put_endpoint(body, 0x81, kBulk, 0, 0, 0);
  put_endpoint(body, 0x02, kBulk, 0, 0, 0);
  put_endpoint(body, 0x83, kBulk, 0, 0, 0);
  put_interface(body, 1, 0, 0);
  put_interface(body, 1, 1, 1);
  put_endpoint(body, 0x84, kIsochronous, 10, 2, 0x8400);  // 3 bursts of 11 packets of 1024
  const auto total = static_cast<std::uint8_t>(9 + body.size());
  descriptors_.configuration = {9, 2, total, 0, 2, 1, 0, 0xC0, 0};
  descriptors_.configuration.insert(descriptors_.configuration.end(), body.begin(), body.end());
  descriptors_.strings = {"mixrig", "Virtual Kinect v2", "000000000001"};
}

void Kinect2Device::configured() {
  (void)pipes_->open();
  (void)pipes_->submit({});
}

/// Alternate setting 0 of the infrared interface ends the stream of pictures.
void Kinect2Device::selected(int interface, int setting) {
  if (interface != kInfraredInterface) return;
  (void)pipes_->set_alternate(interface, setting);
  infrared_.clear(), color_.clear();
}

int Kinect2Device::control(const UsbSetup&, std::span<std::uint8_t>) { return kUsbStall; }

void Kinect2Device::receive(int endpoint, std::span<const std::uint8_t> bytes) {
  if (endpoint == kCommandOut) (void)pipes_->write(static_cast<std::uint8_t>(endpoint), bytes);
}

/// Transmits the next answer, or the rest of one that is longer than a transfer.
int Kinect2Device::answer(std::span<std::uint8_t> room) {
  if (sent_ == size_) {
    const auto got = pipes_->read(0x81, answer_);
    if (!got) return kUsbWait;
    sent_ = 0, size_ = *got;
  }
  const std::size_t count = std::min(room.size(), size_ - sent_);
  std::copy_n(answer_.begin() + static_cast<std::ptrdiff_t>(sent_), count, room.begin());
  sent_ += count;
  return static_cast<int>(count);
}

int Kinect2Device::transmit(int endpoint, std::span<std::uint8_t> room, HostTime) {
  if (endpoint == kCommandIn) return answer(room);
  if (infrared_.empty() && color_.empty())
    (void)pipes_->pump(Duration(0), [this](const device::StreamPacket& p) {
      auto& queue = (p.endpoint & 0x0F) == kInfraredIn ? infrared_ : color_;
      queue.push_back({{p.bytes.begin(), p.bytes.end()}, p.good});
    });
  if (endpoint != kInfraredIn && endpoint != kColorIn) return kUsbWait;
  auto& queue = endpoint == kInfraredIn ? infrared_ : color_;
  if (queue.empty()) return kUsbWait;
  const Packet packet = std::move(queue.front());
  queue.pop_front();
  if (!packet.good) return kUsbLost;
  const std::size_t count = std::min(room.size(), packet.bytes.size());
  std::copy_n(packet.bytes.begin(), count, room.begin());
  return static_cast<int>(count);
}

}  // namespace mixrig::board

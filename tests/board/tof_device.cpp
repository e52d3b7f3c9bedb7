// SPDX-License-Identifier: Apache-2.0
#include "tests/board/tof_device.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mixrig::board {
namespace {

constexpr int kPacketRows = 60;
constexpr std::size_t kUsbPacket = 512;
constexpr std::uint8_t kDescribe = 0x10, kStream = 0x11;
constexpr std::uint16_t kAmplitude = 900, kTemperature = 4150;  // 41.5 degrees

}  // namespace

TofDevice::TofDevice(Size size, double rate_hz) : free_(rate_hz > 0) {
  description_.size = size;
  description_.rate_hz = free_ ? rate_hz : 25;
  description_.amplitude = true;
  description_.depth.metres_per_step = 0.001;
  description_.depth.intrinsics =
      device::DeviceIntrinsics{0.9 * size.width, 0.5 * (size.width - 1), 0.5 * (size.height - 1)};
  if (free_) interval_ = Duration(std::llround(1e9 / rate_hz));
  descriptors_.device = {18, 1, 0, 2, 0, 0, 0, 64, 0x09, 0x12, 0x01, 0x00, 0, 1, 1, 2, 3, 1};
  descriptors_.configuration = {9, 2,    25,   0, 1, 1, 0, 0x80, 250, 9, 4, 0, 0,
                                1, 0xFF, 0x54, 1, 0, 7, 5, 0x81, 2,   0, 2, 0};
  descriptors_.strings = {"mixrig", "Virtual ToF camera", "TOF0001"};
}

void TofDevice::configured() {
  const std::lock_guard lock(mutex_);
  streaming_ = halted_ = false;
}

void TofDevice::clear_halt() {
  const std::lock_guard lock(mutex_);
  halted_ = false;
}

int TofDevice::control(const UsbSetup& setup, std::span<std::uint8_t> data) {
  const std::lock_guard lock(mutex_);
  if (setup.request == kDescribe) {
    const auto bytes = device::pack_tof_description(description_);
    const std::size_t count = std::min(bytes.size(), data.size());
    std::copy_n(bytes.begin(), count, data.begin());
    return static_cast<int>(count);
  }
  if (setup.request != kStream) return kUsbStall;
  streaming_ = setup.value == 1;
  counter_ = 0;
  frame_.clear();
  sent_ = 0;
  end_ = false;
  fired_.reset();
  due_ = {};
  return 0;
}

bool TofDevice::begin_frame(HostTime now) {
  code_ = counter_ % kTofCodes;
  if (free_) {
    if (now < due_) return false;
    due_ = (now - due_ > 2 * interval_ ? now : due_) + interval_;
  } else {
    if (!fired_) return false;
    code_ = *fired_ % kTofCodes;
    fired_.reset();
  }
  TofFault fault = std::exchange(fault_, TofFault::kNone);
  if (every_ > 0 && counter_ % static_cast<std::uint32_t>(every_) == 0) fault = repeated_;
  halted_ = fault == TofFault::kStall;
  frame_.clear();
  ++counter_;
  add_packets(device::TofKind::kDistance, fault, now);
  if (fault != TofFault::kTruncate) add_packets(device::TofKind::kAmplitude, TofFault::kNone, now);
  sent_ = 0;
  end_ = false;
  return !halted_;
}

void TofDevice::add_packets(device::TofKind kind, TofFault fault, HostTime now) {
  const Size size = description_.size;
  std::vector<std::uint8_t> payload;
  for (int row = 0; row < size.height; row += kPacketRows) {
    const int rows = std::min(kPacketRows, size.height - row);
    payload.clear();
    for (int y = row; y < row + rows; ++y)
      for (int x = 0; x < size.width; ++x) {
        const int value = value_at(kind, x, y);
        payload.push_back(static_cast<std::uint8_t>(value));
        payload.push_back(static_cast<std::uint8_t>(value >> 8));
      }
    const bool faulty = row == kPacketRows && fault != TofFault::kNone;
    if (faulty && fault == TofFault::kLosePacket) continue;
    device::TofPacket packet;
    packet.kind = kind;
    packet.temperature = kTemperature;
    packet.frame = counter_;
    packet.first_row = faulty && fault == TofFault::kRowsBeyond ? size.height : row;
    packet.rows = rows;
    packet.size = size;
    packet.payload_bytes = static_cast<std::uint32_t>(payload.size());
    packet.payload_crc = device::tof_crc32(payload);
    packet.time_us = static_cast<std::uint64_t>(now.time_since_epoch().count() / 1000);
    if (faulty && fault == TofFault::kDamage) payload[payload.size() / 2] ^= 0x10;
    const auto header = device::pack_tof_header(packet);
    frame_.insert(frame_.end(), header.begin(), header.end());
    frame_.insert(frame_.end(), payload.begin(), payload.end());
    if (faulty && fault == TofFault::kTruncate) frame_.resize(frame_.size() - payload.size() / 2);
  }
}

int TofDevice::value_at(device::TofKind kind, int x, int y) const {
  if (kind == device::TofKind::kAmplitude) return kAmplitude;
  if (!shown_.empty()) return shown_[static_cast<std::size_t>(y * description_.size.width + x)];
  return x == 0 && y == 0 ? kTofCodeBase_steps + static_cast<int>(code_) : step_at(x, y);
}

int TofDevice::transmit(int endpoint, std::span<std::uint8_t> room, HostTime now) {
  const std::lock_guard lock(mutex_);
  if (halted_) return kUsbStall;
  if (endpoint != 1 || !streaming_) return kUsbWait;
  if (sent_ == frame_.size() && !end_ && !begin_frame(now)) return halted_ ? kUsbStall : kUsbWait;
  const std::size_t count = std::min(room.size(), frame_.size() - sent_);
  std::copy_n(frame_.begin() + static_cast<std::ptrdiff_t>(sent_), count, room.begin());
  sent_ += count;
  // If a frame fills its last USB packet, an empty packet ends it.
  end_ = sent_ == frame_.size() && count > 0 && count % kUsbPacket == 0;
  return static_cast<int>(count);
}

std::optional<HostTime> TofDevice::next_event() {
  const std::lock_guard lock(mutex_);
  if (!streaming_ || !free_ || halted_) return std::nullopt;
  return due_;
}

void TofDevice::fire(std::uint32_t number) {
  const std::lock_guard lock(mutex_);
  if (streaming_ && !free_) fired_ = number;
}

void TofDevice::show(std::vector<std::uint16_t> steps) {
  steps.resize(description_.size.area());
  const std::lock_guard lock(mutex_);
  shown_ = std::move(steps);
  description_.depth.meaning = device::DepthMeaning::kDistance;
}

void TofDevice::fail_next(TofFault fault) {
  const std::lock_guard lock(mutex_);
  fault_ = fault;
}

void TofDevice::fail_every(int n, TofFault fault) {
  const std::lock_guard lock(mutex_);
  every_ = n;
  repeated_ = fault;
}

}  // namespace mixrig::board

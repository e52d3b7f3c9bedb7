// SPDX-License-Identifier: Apache-2.0
#include "tests/board/acm_device.h"

#include <algorithm>

namespace mixrig::board {
namespace {

constexpr std::uint8_t kIn = 1;

}  // namespace

AcmDevice::AcmDevice(const std::string& product, SerialPeer& peer) : peer_(peer) {
  descriptors_.device = {18, 1, 0, 2, 2, 0, 0, 64, 0x09, 0x12, 0x02, 0x00, 0, 1, 1, 2, 3, 1};
  descriptors_.configuration = {
      9, 2, 67, 0, 2, 1, 0, 0x80, 50,
      // communication: abstract control model, its data is interface 1, notifications on 0x83
      9, 4, 0, 0, 1, 2, 2, 1, 0, 5, 0x24, 0, 0x10, 1, 5, 0x24, 1, 0, 1, 4, 0x24, 2, 2, 5, 0x24, 6,
      0, 1, 7, 5, 0x83, 3, 16, 0, 8,
      // data
      9, 4, 1, 0, 2, 10, 0, 0, 0, 7, 5, 0x81, 2, 0, 2, 0, 7, 5, 0x02, 2, 0, 2, 0};
  descriptors_.strings = {"mixrig", product, "ACM0001"};
}

void AcmDevice::configured() {
  out_.clear();
  peer_.plugged(SystemClock().now());
}

void AcmDevice::receive(int, std::span<const std::uint8_t> bytes) {
  peer_.receive(bytes, SystemClock().now());
}

int AcmDevice::transmit(int endpoint, std::span<std::uint8_t> room, HostTime now) {
  if (endpoint != kIn) return kUsbWait;
  peer_.transmit_ready(out_, now);
  if (out_.empty()) return kUsbWait;
  const std::size_t count = std::min(room.size(), out_.size());
  std::copy_n(out_.begin(), count, room.begin());
  out_.erase(out_.begin(), out_.begin() + static_cast<std::ptrdiff_t>(count));
  return static_cast<int>(count);
}

void PtuPeer::receive(std::span<const std::uint8_t> bytes, HostTime now) {
  const std::lock_guard lock(mutex_);
  const HostTime read = now + byte_time_ * static_cast<long>(bytes.size());
  unit_.receive(bytes, read);
  ready_ = read + byte_time_ * static_cast<long>(unit_.output().size());
}

std::optional<HostTime> PtuPeer::next_event() {
  const std::lock_guard lock(mutex_);
  if (unit_.output().empty()) return std::nullopt;
  return ready_;
}

void PtuPeer::transmit_ready(std::vector<std::uint8_t>& out, HostTime now) {
  const std::lock_guard lock(mutex_);
  if (now < ready_) return;
  out.insert(out.end(), unit_.output().begin(), unit_.output().end());
  unit_.output().clear();
}

void PtuPeer::set_faults(const fake::FlirPtuEmulator::Faults& faults) {
  const std::lock_guard lock(mutex_);
  unit_.faults = faults;
}

std::array<long, 2> PtuPeer::position(HostTime now) {
  const std::lock_guard lock(mutex_);
  return unit_.position(now);
}

void PtuPeer::order(const std::string& words, HostTime now) {
  const std::lock_guard lock(mutex_);
  const std::size_t kept = unit_.output().size();
  unit_.receive({reinterpret_cast<const std::uint8_t*>(words.data()), words.size()}, now);
  unit_.output().resize(kept);
}

std::uint64_t PtuPeer::limit_reports() const {
  const std::lock_guard lock(mutex_);
  return unit_.limit_reports();
}

}  // namespace mixrig::board

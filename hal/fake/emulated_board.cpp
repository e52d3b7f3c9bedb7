// SPDX-License-Identifier: Apache-2.0
#include "hal/fake/emulated_board.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "firmware/protocol/image_header.h"

namespace mixrig::fake {

namespace {

std::uint32_t word_at(const EmulatedFlash& flash, std::uint32_t offset) {
  std::uint32_t word = 0;
  std::memcpy(&word, flash.bytes().data() + offset, sizeof word);
  return word;
}

bool has_vectors(const EmulatedFlash& flash) {
  const std::uint32_t stack = word_at(flash, 0);
  const std::uint32_t entry = word_at(flash, 4);
  return stack >> 20 == 0x200 && EmulatedFlash::contains(entry, 2);
}

/// Result of the firmware's own image check.
bool image_good(const EmulatedFlash& flash, std::uint32_t& crc) {
  protocol::ImageHeader header;
  std::memcpy(&header, flash.bytes().data() + protocol::kHeaderOffset, sizeof header);
  const bool plausible = header.magic == protocol::kImageMagic &&
                         header.size >= protocol::kHeaderOffset + sizeof header &&
                         header.size <= protocol::kMaxImage;
  if (!plausible) return false;
  crc = protocol::image_crc(flash.bytes().first(header.size));
  return crc == header.crc;
}

}  // namespace

void EmulatedBoard::power_cycle(bool boot0) {
  flash_.power_on();
  rom_.reset();
  firmware_.reset();
  mode_ = BoardMode::kBootloader;
  if (!boot0) boot(protocol::ResetCause::kPower);
}

void EmulatedBoard::boot(protocol::ResetCause cause) {
  firmware_.reset();
  mode_ = BoardMode::kNothing;
  if (!has_vectors(flash_)) return;
  port::Identity identity;
  identity.reset_cause = cause;
  identity.image_bad = !image_good(flash_, identity.image_crc);
  firmware_ = std::make_unique<sim::SimBoard>(identity);
  boot_us_ = time_us_;
  mode_ = BoardMode::kFirmware;
}

void EmulatedBoard::receive(std::span<const std::uint8_t> bytes) {
  if (!flash_.powered()) return;
  if (mode_ == BoardMode::kFirmware) firmware_->receive(bytes);
  if (mode_ == BoardMode::kBootloader) {
    for (const std::uint8_t byte : bytes) rom_.receive(byte);
  }
}

std::vector<std::uint8_t> EmulatedBoard::transmitted() {
  std::vector<std::uint8_t> bytes;
  if (mode_ == BoardMode::kFirmware) bytes = firmware_->transmitted();
  if (mode_ == BoardMode::kBootloader) bytes = std::exchange(rom_.output(), {});
  follow();
  return bytes;
}

/// Switches between firmware and bootloader when one has started the other.
void EmulatedBoard::follow() {
  if (!flash_.powered()) mode_ = BoardMode::kNothing;
  if (mode_ == BoardMode::kFirmware && firmware_->in_bootloader()) {
    firmware_.reset();
    rom_.reset();
    mode_ = BoardMode::kBootloader;
  } else if (mode_ == BoardMode::kBootloader && rom_.gone_to()) {
    boot(protocol::ResetCause::kUnknown);
  }
}

void EmulatedBoard::advance_to(std::uint64_t time_us) {
  time_us_ = std::max(time_us_, time_us);
  if (mode_ == BoardMode::kFirmware) firmware_->advance_to(time_us_ - boot_us_);
}

std::uint64_t EmulatedBoard::next_event_us() const {
  if (mode_ != BoardMode::kFirmware) return UINT64_MAX;
  return boot_us_ + firmware_->next_event_us();
}

std::uint64_t BoardStream::board_time_us(HostTime host) const {
  const double us = static_cast<double>(host.time_since_epoch().count()) * 1e-3;
  return static_cast<std::uint64_t>(std::floor(us * (1 + line.drift_ppm * 1e-6)));
}

HostTime BoardStream::host_time(double board_us) const {
  const double ns = std::ceil(board_us * 1e3 / (1 + line.drift_ppm * 1e-6));
  return HostTime(Duration(static_cast<Duration::rep>(ns)));
}

HostTime BoardStream::arrival(std::deque<Parcel>& queue) {
  HostTime at = clock_.now();
  if (line.delay_max > Duration{0}) {
    std::uniform_int_distribution<Duration::rep> delay(0, line.delay_max.count());
    at += Duration(delay(random_));
  }
  return queue.empty() ? at : std::max(at, queue.back().at);
}

void BoardStream::damage(std::vector<std::uint8_t>& bytes) {
  if (line.byte_error_share <= 0) return;
  std::bernoulli_distribution hit(line.byte_error_share);
  for (std::uint8_t& byte : bytes) {
    if (hit(random_)) byte ^= static_cast<std::uint8_t>(1 + random_() % 255);
  }
}

Result<void> BoardStream::write(std::span<const std::uint8_t> bytes) {
  if (line.cut) return {};
  Parcel parcel{arrival(to_board_), {bytes.begin(), bytes.end()}};
  damage(parcel.bytes);
  to_board_.push_back(std::move(parcel));
  run_until(clock_.now());
  return {};
}

Result<void> BoardStream::set_line(const device::LineSettings& wanted) {
  settings = wanted;
  return {};
}

/// Delivers the bytes that are due at the present time.
void BoardStream::deliver() {
  board_.advance_to(board_time_us(clock_.now()));
  while (!to_board_.empty() && to_board_.front().at <= clock_.now()) {
    board_.receive(to_board_.front().bytes);
    to_board_.pop_front();
  }
  // Twice: after a change of mode the board may send again at once.
  for (int i = 0; i < 2; ++i) {
    std::vector<std::uint8_t> bytes = board_.transmitted();
    if (bytes.empty() || line.cut) continue;
    damage(bytes);
    to_host_.push_back({arrival(to_host_), std::move(bytes)});
  }
}

void BoardStream::run_until(HostTime until) {
  for (;;) {
    deliver();
    HostTime next = until;
    if (!to_board_.empty()) next = std::min(next, to_board_.front().at);
    if (!to_host_.empty()) next = std::min(next, to_host_.front().at);
    const std::uint64_t event_us = board_.next_event_us();
    if (event_us != UINT64_MAX) {
      next = std::min(next, std::max(host_time(static_cast<double>(event_us)),
                                     clock_.now() + std::chrono::microseconds(1)));
    }
    if (!to_host_.empty() && to_host_.front().at <= clock_.now()) return;
    if (clock_.now() >= until) return;
    clock_.sleep_until(next);
  }
}

Result<std::size_t> BoardStream::read(std::span<std::uint8_t> out, Duration timeout) {
  run_until(clock_.now() + std::max(timeout, Duration{0}));
  if (to_host_.empty() || to_host_.front().at > clock_.now()) return std::size_t{0};
  std::vector<std::uint8_t>& bytes = to_host_.front().bytes;
  const std::size_t count = std::min(out.size(), bytes.size());
  std::copy_n(bytes.begin(), count, out.begin());
  bytes.erase(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count));
  if (bytes.empty()) to_host_.pop_front();
  return count;
}

}  // namespace mixrig::fake

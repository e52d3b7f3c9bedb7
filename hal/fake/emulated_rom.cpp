// SPDX-License-Identifier: Apache-2.0
#include "hal/fake/emulated_rom.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace mixrig::fake {

namespace {

constexpr std::uint8_t kAck = 0x79;
constexpr std::uint8_t kNack = 0x1F;
constexpr std::uint8_t kSync = 0x7F;
constexpr std::uint8_t kVersion = 0x31;
enum Command : std::uint8_t {
  kGet = 0x00,
  kGetVersion = 0x01,
  kGetId = 0x02,
  kRead = 0x11,
  kGo = 0x21,
  kWrite = 0x31,
  kExtendedErase = 0x44,
};
constexpr std::array<std::uint8_t, 7> kCommands = {kGet, kGetVersion, kGetId,        kRead,
                                                   kGo,  kWrite,      kExtendedErase};

/// Readable memory of the F405 besides flash and RAM: unique number, flash size in KiB, option
/// bytes.
constexpr std::uint32_t kUidBase = 0x1FFF7A10;
constexpr std::array<std::uint8_t, 20> kUid = {'E', 'M', 'U', 'L', 'A', 'T', 'E', 'D', 'R', 'O',
                                               'M', '1', 255, 255, 255, 255, 255, 255, 0,   4};
constexpr std::uint32_t kOptionBase = 0x1FFFC000;
constexpr std::array<std::uint8_t, 16> kOptions = {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF,
                                                   0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF};

std::uint8_t xor_of(std::span<const std::uint8_t> bytes) {
  return std::accumulate(bytes.begin(), bytes.end(), std::uint8_t{0},
                         [](std::uint8_t a, std::uint8_t b) { return a ^ b; });
}

}  // namespace

void EmulatedRom::reset() {
  synchronized_ = false;
  gone_to_.reset();
  input_.clear();
  output_.clear();
}

void EmulatedRom::expect(std::size_t bytes, Handler then) {
  input_.clear();
  needed_ = bytes;
  then_ = then;
}

bool EmulatedRom::acknowledge() {
  if (!flash_.powered()) return false;
  if (++answers_ == nack_at_) {
    output_.push_back(kNack);
    await_command();
    return false;
  }
  output_.push_back(kAck);
  return true;
}

void EmulatedRom::refuse() {
  if (flash_.powered()) output_.push_back(kNack);
  await_command();
}

void EmulatedRom::answer(std::span<const std::uint8_t> bytes) {
  output_.insert(output_.end(), bytes.begin(), bytes.end());
}

void EmulatedRom::receive(std::uint8_t byte) {
  if (!flash_.powered() || gone_to_) return;
  if (!synchronized_) {
    // The bootloader measures the baud rate on the first 0x7F and ignores other bytes.
    if (byte != kSync) return;
    synchronized_ = true;
    await_command();
    acknowledge();
    return;
  }
  input_.push_back(byte);
  if (input_.size() >= needed_) (this->*then_)();
}

void EmulatedRom::on_command() {
  const std::uint8_t command = input_[0];
  const bool known = std::find(kCommands.begin(), kCommands.end(), command) != kCommands.end();
  if ((command ^ input_[1]) != 0xFF || !known) return refuse();
  if (!acknowledge()) return;
  switch (command) {
    case kGet:
      output_.push_back(kCommands.size());
      output_.push_back(kVersion);
      answer(kCommands);
      break;
    case kGetVersion:
      answer(std::array<std::uint8_t, 3>{kVersion, 0, 0});
      break;
    case kGetId:
      answer(std::array<std::uint8_t, 3>{1, static_cast<std::uint8_t>(chip_id >> 8),
                                         static_cast<std::uint8_t>(chip_id)});
      break;
    case kRead:
      return expect(5, &EmulatedRom::on_read_address);
    case kGo:
      return expect(5, &EmulatedRom::on_go_address);
    case kWrite:
      return expect(5, &EmulatedRom::on_write_address);
    default:
      return expect(2, &EmulatedRom::on_erase_count);
  }
  await_command();
  acknowledge();
}

bool EmulatedRom::take_address() {
  address_ = 0;
  for (int i = 0; i < 4; ++i) address_ = address_ << 8 | input_[static_cast<std::size_t>(i)];
  return xor_of(input_) == 0;
}

std::span<const std::uint8_t> EmulatedRom::readable(std::uint32_t address, std::size_t size) const {
  if (EmulatedFlash::contains(address, size)) return flash_.read(address, size);
  const auto within = [&](std::uint32_t base, std::span<const std::uint8_t> memory) {
    const bool inside = address >= base && address - base <= memory.size() &&
                        size <= memory.size() - (address - base);
    return inside ? memory.subspan(address - base, size) : std::span<const std::uint8_t>{};
  };
  if (address >= kRamBase + kOwnRam) {
    if (const auto found = within(kRamBase, ram_); !found.empty()) return found;
  }
  if (const auto found = within(kUidBase, kUid); !found.empty()) return found;
  return within(kOptionBase, kOptions);
}

void EmulatedRom::on_read_address() {
  if (!take_address() || readable(address_, 1).empty()) return refuse();
  if (acknowledge()) expect(2, &EmulatedRom::on_read_count);
}

void EmulatedRom::on_read_count() {
  const std::size_t size = input_[0] + std::size_t{1};
  if ((input_[0] ^ input_[1]) != 0xFF) return refuse();
  const auto bytes = readable(address_, size);
  if (bytes.empty()) return refuse();
  await_command();
  if (acknowledge()) answer(bytes);
}

void EmulatedRom::on_write_address() {
  if (!take_address() || address_ % 4 != 0) return refuse();
  const bool writable = EmulatedFlash::contains(address_, 1) || address_ >= kRamBase + kOwnRam;
  if (!writable || readable(address_, 1).empty()) return refuse();
  if (acknowledge()) expect(1, &EmulatedRom::on_write_size);
}

void EmulatedRom::on_write_size() {
  // The size stays in front of the data: the checksum covers it.
  needed_ = input_[0] + std::size_t{3};
  then_ = &EmulatedRom::on_write_data;
}

void EmulatedRom::on_write_data() {
  const std::size_t size = input_[0] + std::size_t{1};
  if (xor_of(input_) != 0 || size % 4 != 0 || readable(address_, size).empty()) return refuse();
  const std::vector<std::uint8_t> data(input_.begin() + 1, input_.end() - 1);
  bool written = true;
  if (EmulatedFlash::contains(address_, size)) {
    written = flash_.program(address_, data);
  } else {
    std::copy(data.begin(), data.end(), ram_.begin() + (address_ - kRamBase));
  }
  await_command();
  if (written) acknowledge();
}

void EmulatedRom::on_erase_count() {
  const unsigned count = static_cast<unsigned>(input_[0]) << 8 | input_[1];
  if (count >= 0xFFF0) {
    needed_ = 3;
    then_ = &EmulatedRom::on_erase_all;
    return;
  }
  needed_ = 2 + 2 * (count + std::size_t{1}) + 1;
  then_ = &EmulatedRom::on_erase_pages;
}

void EmulatedRom::on_erase_all() {
  // One bank only: of the special codes the F405 supports the mass erase alone.
  if (xor_of(input_) != 0 || input_[1] != 0xFF) return refuse();
  await_command();
  if (flash_.erase_all()) acknowledge();
}

void EmulatedRom::on_erase_pages() {
  if (xor_of(input_) != 0) return refuse();
  std::vector<int> sectors;
  for (std::size_t i = 2; i + 2 < input_.size(); i += 2) {
    sectors.push_back(input_[i] << 8 | input_[i + 1]);
  }
  if (*std::max_element(sectors.begin(), sectors.end()) >= EmulatedFlash::kSectors) return refuse();
  await_command();
  for (const int sector : sectors) {
    if (!flash_.erase_sector(sector)) return;
  }
  acknowledge();
}

void EmulatedRom::on_go_address() {
  if (!take_address() || readable(address_, 8).empty()) return refuse();
  await_command();
  if (acknowledge()) gone_to_ = address_;
}

}  // namespace mixrig::fake

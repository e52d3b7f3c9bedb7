// SPDX-License-Identifier: Apache-2.0
#include "hal/fake/emulated_flash.h"

#include <algorithm>

namespace mixrig::fake {

std::uint32_t EmulatedFlash::sector_begin(int sector) {
  constexpr std::uint32_t kKiB = 1024;
  if (sector <= 4) return static_cast<std::uint32_t>(sector) * 16 * kKiB;
  return 64 * kKiB + 64 * kKiB + static_cast<std::uint32_t>(sector - 5) * 128 * kKiB;
}

std::optional<int> EmulatedFlash::sector_of(std::uint32_t address) {
  if (!contains(address, 1)) return std::nullopt;
  int sector = 0;
  while (sector_begin(sector + 1) <= address - kBase) ++sector;
  return sector;
}

bool EmulatedFlash::contains(std::uint32_t address, std::size_t size) {
  return address >= kBase && address - kBase <= kSize && size <= kSize - (address - kBase);
}

bool EmulatedFlash::begin_change(bool& failing) {
  if (!powered_) return false;
  failing = ++changes_ == fail_at_;
  if (failing) powered_ = false;
  return true;
}

void EmulatedFlash::settle() {
  if (worn_) bytes_[*worn_] &= 0xFE;
}

bool EmulatedFlash::program(std::uint32_t address, std::span<const std::uint8_t> data) {
  bool failing = false;
  if (!contains(address, data.size()) || !begin_change(failing)) return false;
  if (failing) data = data.first(data.size() / 2);
  for (std::size_t i = 0; i < data.size(); ++i) bytes_[address - kBase + i] &= data[i];
  settle();
  return !failing;
}

bool EmulatedFlash::erase_sector(int sector) {
  bool failing = false;
  if (sector < 0 || sector >= kSectors || !begin_change(failing)) return false;
  const std::uint32_t begin = sector_begin(sector);
  std::uint32_t end = sector_begin(sector + 1);
  // Interrupted midway: the first half is blank, the rest unchanged.
  if (failing) end = begin + (end - begin) / 2;
  std::fill(bytes_.begin() + begin, bytes_.begin() + end, std::uint8_t{0xFF});
  settle();
  return !failing;
}

bool EmulatedFlash::erase_all() {
  bool done = true;
  for (int sector = 0; sector < kSectors && done; ++sector) done = erase_sector(sector);
  return done;
}

std::span<const std::uint8_t> EmulatedFlash::read(std::uint32_t address, std::size_t size) const {
  return std::span(bytes_).subspan(address - kBase, size);
}

void EmulatedFlash::load(std::span<const std::uint8_t> image) {
  std::copy(image.begin(), image.end(), bytes_.begin());
}

}  // namespace mixrig::fake

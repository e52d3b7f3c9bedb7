// SPDX-License-Identifier: Apache-2.0
#include "hal/wire/flash/dfuse.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <string>

namespace mixrig::device {

namespace {

constexpr std::uint8_t kDownload = 1, kUpload = 2, kGetStatus = 3, kClearStatus = 4, kAbort = 6;
constexpr std::uint8_t kSetPointer = 0x21, kErase = 0x41;
constexpr std::uint16_t kFirstBlock = 2;
enum State : std::uint8_t {
  kIdle = 2,
  kDownloadBusy = 4,
  kDownloadIdle = 5,
  kManifest = 7,
  kUploadIdle = 9,
  kErrorState = 10,
};
constexpr int kMaxPolls = 200;
constexpr Duration kLongestPoll = std::chrono::seconds(3);
constexpr std::size_t kMaxSectors = 1024;

Error dfu_refused(const std::string& what) {
  return Error{ErrorCode::kDevice, "USB bootloader refused to " + what};
}

/// Reads a number and removes it from `text`; false where there is none.
bool take_number(std::string_view& text, std::uint32_t& value, int base) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  if (error != std::errc{}) return false;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return true;
}

bool take(std::string_view& text, std::string_view what) {
  if (!text.starts_with(what)) return false;
  text.remove_prefix(what.size());
  return true;
}

/// Parses a group of sectors, "04*016Kg": count, size, unit, and rights a..g as bits read, erase,
/// write.
bool take_sectors(std::string_view& text, std::uint32_t& address,
                  std::vector<FlashSector>& sectors) {
  std::uint32_t count = 0, size = 0;
  if (!take_number(text, count, 10) || !take(text, "*") || !take_number(text, size, 10)) {
    return false;
  }
  if (text.size() < 2) return false;
  const char unit = text[0];
  const bool all_rights = (text[1] & 7) == 7;
  text.remove_prefix(2);
  const std::uint64_t bytes = std::uint64_t{size} * (unit == 'K'   ? 1024u
                                                     : unit == 'M' ? 1024u * 1024u
                                                                   : 1u);
  if (count > kMaxSectors || bytes == 0 || bytes * count > UINT32_MAX - address) return false;
  for (std::uint32_t i = 0; i < count; ++i, address += static_cast<std::uint32_t>(bytes)) {
    if (all_rights) sectors.push_back({address, static_cast<std::uint32_t>(bytes)});
  }
  return sectors.size() <= kMaxSectors;
}

bool is_f405(const std::vector<FlashSector>& sectors) {
  constexpr std::uint32_t kKiB = 1024;
  const auto has = [&](std::size_t i, std::uint32_t address, std::uint32_t size) {
    return sectors.size() > i && sectors[i] == FlashSector{address, size};
  };
  return has(0, 0x08000000, 16 * kKiB) && has(4, 0x08010000, 64 * kKiB) &&
         has(5, 0x08020000, 128 * kKiB);
}

}  // namespace

std::vector<FlashSector> parse_memory_layout(std::string_view text) {
  std::vector<FlashSector> sectors;
  const std::size_t name_end = text.find('/');
  if (!text.starts_with("@") || name_end == std::string_view::npos) return {};
  text.remove_prefix(name_end);
  while (take(text, "/")) {
    std::uint32_t address = 0;
    if (!take(text, "0x") || !take_number(text, address, 16) || !take(text, "/")) return {};
    do {
      if (!take_sectors(text, address, sectors)) return {};
    } while (take(text, ","));
  }
  return text.empty() ? sectors : std::vector<FlashSector>{};
}

Result<Dfuse::Status> Dfuse::get_status() {
  std::array<std::uint8_t, 6> bytes{};
  MIXRIG_ASSIGN(const std::size_t n, usb_.receive(kGetStatus, 0, bytes));
  if (n != bytes.size()) return dfu_refused("report its state");
  const int poll_ms = bytes[1] | bytes[2] << 8 | bytes[3] << 16;
  return Status{bytes[0], bytes[4],
                std::min<Duration>(std::chrono::milliseconds(poll_ms), kLongestPoll)};
}

/// Leaves the state that an aborted transfer may have left.
Result<void> Dfuse::become_idle() {
  for (int i = 0; i < 4; ++i) {
    MIXRIG_ASSIGN(const Status status, get_status());
    if (status.state == kIdle) return {};
    const std::uint8_t request = status.state == kErrorState ? kClearStatus : kAbort;
    MIXRIG_TRY(usb_.send(request, 0, {}));
  }
  return dfu_refused("become idle: unplug it and try again");
}

/// The device carries out a download when its status is read: it is busy first, then idle or in
/// error.
Result<void> Dfuse::finish_download(const char* what) {
  for (int i = 0; i < kMaxPolls; ++i) {
    MIXRIG_ASSIGN(const Status status, get_status());
    if (status.status != 0 || status.state == kErrorState) {
      MIXRIG_TRY(usb_.send(kClearStatus, 0, {}));
      return dfu_refused(std::string(what) + ", status " + std::to_string(status.status));
    }
    if (status.state == kDownloadIdle) return {};
    clock_.sleep_until(clock_.now() + status.poll);
  }
  return Error{ErrorCode::kTimeout, std::string("USB bootloader does not finish to ") + what};
}

Result<void> Dfuse::command(std::uint8_t code, std::uint32_t address, const char* what) {
  const std::array<std::uint8_t, 5> bytes = {
      code, static_cast<std::uint8_t>(address), static_cast<std::uint8_t>(address >> 8),
      static_cast<std::uint8_t>(address >> 16), static_cast<std::uint8_t>(address >> 24)};
  MIXRIG_TRY(usb_.send(kDownload, 0, bytes));
  return finish_download(what);
}

Result<BootloaderInfo> Dfuse::connect() {
  MIXRIG_TRY(become_idle());
  const DfuInterface& dfu = usb_.dfu();
  std::vector<FlashSector> sectors = parse_memory_layout(dfu.memory_layout);
  if (dfu.transfer_size < 4 || !is_f405(sectors)) {
    return Error{ErrorCode::kDevice, "wrong board: flash layout \"" + dfu.memory_layout +
                                         "\" is not that of an STM32F405; nothing was erased"};
  }
  sectors_ = std::move(sectors);
  return BootloaderInfo{"STM32 USB bootloader (DfuSe)", 0, sectors_};
}

Result<void> Dfuse::erase(const FlashSector& sector) {
  // The device would erase whichever sector contains the address.
  const bool known = std::find(sectors_.begin(), sectors_.end(), sector) != sectors_.end();
  return known ? command(kErase, sector.address, "erase flash")
               : dfu_refused("erase an address range that is no sector");
}

Result<void> Dfuse::write(std::uint32_t address, std::span<const std::uint8_t> data) {
  MIXRIG_TRY(command(kSetPointer, address, "set an address"));
  std::uint16_t block = kFirstBlock;
  while (!data.empty()) {
    const std::size_t size = std::min(data.size(), usb_.dfu().transfer_size);
    MIXRIG_TRY(usb_.send(kDownload, block++, data.first(size)));
    MIXRIG_TRY(finish_download("write flash (write protection?)"));
    data = data.subspan(size);
  }
  return become_idle();
}

Result<void> Dfuse::read(std::uint32_t address, std::span<std::uint8_t> out) {
  MIXRIG_TRY(command(kSetPointer, address, "set an address"));
  MIXRIG_TRY(become_idle());  // uploads start in the idle state
  std::uint16_t block = kFirstBlock;
  while (!out.empty()) {
    const std::size_t size = std::min(out.size(), usb_.dfu().transfer_size);
    MIXRIG_ASSIGN(const std::size_t n, usb_.receive(kUpload, block++, out.first(size)));
    if (n != size) return dfu_refused("read flash (read protection?)");
    out = out.subspan(size);
  }
  return become_idle();
}

Result<void> Dfuse::go(std::uint32_t address) {
  MIXRIG_TRY(command(kSetPointer, address, "set an address"));
  MIXRIG_TRY(usb_.send(kDownload, 0, {}));
  // There may be no answer any more: the device leaves the bus.
  (void)get_status();
  return {};
}

}  // namespace mixrig::device

// SPDX-License-Identifier: Apache-2.0
#include "hal/wire/flash/flash_image.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>

#include <fmt/format.h>

#include "hal/base/log.h"
#include "hal/wire/flash/stm32_rom.h"
#include "hal/wire/trigger/mcu_link.h"

namespace mixrig::device {

using protocol::kFlashBase;
using protocol::kHeaderOffset;
using protocol::kVectorBlock;

namespace {

constexpr std::size_t kLongestPiece = 256, kShortestPiece = 16;
constexpr int kReadTries = 32;
/// Rounds of writing and verifying. The bootloader's checksum is one byte: damaged data may pass it
/// and be written.
constexpr int kRounds = 4;
/// Requests to running firmware to start the bootloader.
constexpr int kEntryTries = 8;
/// Initial stack pointer and entry point: written last. Without them nothing boots.
constexpr std::size_t kEntryWords = 8;

/// Adds to the reason that the board will not boot now.
Error unfinished(Error error) {
  error.context += "; the board will not boot now: flash again, with BOOT0 held at reset";
  return error;
}

std::vector<FlashSector> sectors_under(const BootloaderInfo& info, std::size_t size) {
  std::vector<FlashSector> sectors;
  for (const FlashSector& sector : info.sectors) {
    if (sector.address >= kFlashBase && sector.address < kFlashBase + size) {
      sectors.push_back(sector);
    }
  }
  return sectors;
}

/// Processes `size` bytes piece by piece. `attempt(at, n)` returns whether a piece was correct; if
/// not, a shorter one is tried, which passes a noisy line more often. Returns the offset at which
/// no try was correct, or `size`.
template <typename Attempt>
Result<std::size_t> in_pieces(std::size_t size, const char* what, const FlashProgress& progress,
                              Attempt attempt) {
  std::size_t longest = kLongestPiece, at = 0;
  for (int tries = 0; at < size;) {
    const std::size_t n = std::min(longest, size - at);
    MIXRIG_ASSIGN(const bool right, attempt(at, n));
    if (right) {
      at += n;
      tries = 0;
      longest = std::min(2 * longest, kLongestPiece);
      progress(what, at, size);
    } else if (++tries == kReadTries) {
      return at;
    } else {
      longest = std::max(longest / 2, kShortestPiece);
    }
  }
  return size;
}

std::uint32_t address_of(std::size_t offset) {
  return static_cast<std::uint32_t>(kFlashBase + offset);
}

/// Reads from the start of flash. Each piece is read until two readings agree.
Result<void> read_twice(Bootloader& bootloader, std::span<std::uint8_t> out,
                        const FlashProgress& progress) {
  std::array<std::uint8_t, kLongestPiece> again;
  const auto attempt = [&](std::size_t at, std::size_t n) -> Result<bool> {
    const auto once = out.subspan(at, n), twice = std::span(again).first(n);
    MIXRIG_TRY(bootloader.read(address_of(at), once));
    MIXRIG_TRY(bootloader.read(address_of(at), twice));
    return std::equal(once.begin(), once.end(), twice.begin());
  };
  MIXRIG_ASSIGN(const std::size_t read, in_pieces(out.size(), "read old image", progress, attempt));
  if (read == out.size()) return {};
  return Error{ErrorCode::kDevice,
               "flash reads differently each time: check cable and ground; nothing was erased"};
}

/// Compares flash from `begin` on. A difference counts only if it is read repeatedly.
Result<void> verify_range(Bootloader& bootloader, std::span<const std::uint8_t> wanted,
                          std::size_t begin, const FlashProgress& progress) {
  std::array<std::uint8_t, kLongestPiece> got;
  std::size_t differs = 0;
  const auto attempt = [&](std::size_t at, std::size_t n) -> Result<bool> {
    const auto here = wanted.subspan(at, n);
    MIXRIG_TRY(bootloader.read(address_of(begin + at), std::span(got).first(n)));
    const auto end = std::mismatch(here.begin(), here.end(), got.begin()).first;
    differs = at + static_cast<std::size_t>(end - here.begin());
    return end == here.end();
  };
  MIXRIG_ASSIGN(const std::size_t same, in_pieces(wanted.size(), "verify", progress, attempt));
  if (same == wanted.size()) return {};
  return Error{ErrorCode::kData, fmt::format("flash differs from the image at {:#010x}",
                                             address_of(begin + differs))};
}

Result<void> write_range(Bootloader& bootloader, std::span<const std::uint8_t> bytes,
                         std::size_t begin, std::size_t end, const FlashProgress& progress) {
  for (std::size_t at = begin; at < end; at += kVectorBlock) {
    const std::size_t size = std::min(kVectorBlock, end - at);
    MIXRIG_TRY(bootloader.write(address_of(at), bytes.subspan(at, size)));
    progress("write", at + size - begin, end - begin);
  }
  return verify_range(bootloader, bytes.subspan(begin, end - begin), begin, progress);
}

Result<void> rewrite(Bootloader& bootloader, const std::vector<FlashSector>& sectors,
                     std::span<const std::uint8_t> bytes, const FlashProgress& progress) {
  const std::size_t size = bytes.size();
  std::size_t erased = 0;
  // The sector of the vector table is erased first: from here on the old image cannot boot.
  for (const FlashSector& sector : sectors) {
    MIXRIG_TRY(bootloader.erase(sector));
    progress("erase", ++erased, sectors.size());
  }
  MIXRIG_TRY(write_range(bootloader, bytes, kVectorBlock, size, progress));
  MIXRIG_TRY(write_range(bootloader, bytes, kEntryWords, kVectorBlock, progress));
  return write_range(bootloader, bytes, 0, kEntryWords, progress);
}

}  // namespace

Result<PreviousFlash> read_previous(Bootloader& bootloader, const BootloaderInfo& info,
                                    std::size_t size, const FlashProgress& progress) {
  PreviousFlash previous;
  previous.bytes.resize(kHeaderOffset + sizeof(protocol::ImageHeader));
  MIXRIG_TRY(read_twice(bootloader, previous.bytes, progress));
  protocol::ImageHeader header;
  std::memcpy(&header, previous.bytes.data() + kHeaderOffset, sizeof header);
  previous.blank = std::all_of(previous.bytes.begin(), previous.bytes.end(),
                               [](std::uint8_t byte) { return byte == 0xFF; });
  if (previous.blank) {
    previous.bytes.clear();
    return previous;
  }
  std::size_t total = 0;
  for (const FlashSector& sector : sectors_under(info, size)) total += sector.size;
  const bool ours = header.magic == protocol::kImageMagic && header.size > previous.bytes.size() &&
                    header.size <= protocol::kMaxImage && header.size % 4 == 0;
  previous.bytes.resize(ours ? header.size : total);
  MIXRIG_TRY(read_twice(bootloader, previous.bytes, progress));
  return previous;
}

Result<void> write_flash(Bootloader& bootloader, const BootloaderInfo& info,
                         std::span<const std::uint8_t> bytes, const FlashProgress& progress) {
  const std::vector<FlashSector> sectors = sectors_under(info, bytes.size());
  const bool fits = !sectors.empty() && bytes.size() > kVectorBlock && bytes.size() % 4 == 0 &&
                    sectors.front().address == kFlashBase &&
                    sectors.back().address + sectors.back().size >= kFlashBase + bytes.size();
  if (!fits) {
    return Error{ErrorCode::kUsage, "image of " + std::to_string(bytes.size()) +
                                        " bytes does not fit the chip's flash; nothing was erased"};
  }
  Result<void> done;
  for (int round = 1; round <= kRounds; ++round) {
    done = rewrite(bootloader, sectors, bytes, progress);
    if (done) return {};
    if (done.error().code != ErrorCode::kData) break;
    if (round < kRounds) log_warning("flash", done.error().context + ": writing all of it again");
  }
  return unfinished(done.error());
}

Result<void> verify_flash(Bootloader& bootloader, std::span<const std::uint8_t> bytes,
                          const FlashProgress& progress) {
  return verify_range(bootloader, bytes, 0, progress);
}

Result<void> enter_bootloader(ByteStream& stream, Clock& clock, const std::string& name) {
  Stm32Rom rom(stream, clock);
  const protocol::Reboot reboot{protocol::RebootTarget::kBootloader, protocol::kRebootKey};
  // Each try checks for the bootloader first: if it runs already, a second frame would disturb its
  // baud rate detection. So the link must not resend this command.
  const McuLink::RetryPolicy once{std::chrono::milliseconds(200), 1};
  for (int i = 0; i < kEntryTries; ++i) {
    MIXRIG_ASSIGN(const bool there, rom.answers());
    if (there) return {};
    MIXRIG_TRY(stream.set_line({}));
    protocol::Verdict verdict = protocol::Verdict::kOk;
    McuLink link(stream, clock, name);
    const auto asked = link.ask(reboot, once, nullptr, &verdict);
    if (asked && verdict == protocol::Verdict::kOk) return {};
    if (asked && verdict == protocol::Verdict::kState) {
      return Error{ErrorCode::kDevice,
                   "triggers are running at " + name + ": stop them first (mixrig trigger stop)"};
    }
    if (asked) {
      return Error{ErrorCode::kDevice, "trigger controller at " + name + " " + meaning(verdict)};
    }
    if (asked.error().code != ErrorCode::kTimeout) return asked.error();
  }
  return Error{ErrorCode::kTimeout, "neither firmware nor bootloader answers at " + name +
                                        ": check cable and power, or hold BOOT0 at reset"};
}

}  // namespace mixrig::device

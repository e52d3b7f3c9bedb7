// SPDX-License-Identifier: Apache-2.0
#include "hal/linux/flash_image.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <memory>

#include "hal/linux/mcu_link.h"
#include "hal/linux/stm32_rom.h"

namespace mixrig::device {

using protocol::kFlashBase;
using protocol::kHeaderOffset;
using protocol::kVectorBlock;

namespace {

constexpr std::size_t kStep = 256;
constexpr int kReadTries = 8;
/// Stack and entry: the last words written. Without them nothing runs.
constexpr std::size_t kEntryWords = 8;

/// Tells that the board will not boot as it is, after the reason.
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

Result<void> read_range(Bootloader& bootloader, std::size_t begin, std::span<std::uint8_t> out,
                        const char* what, const FlashProgress& progress) {
  for (std::size_t done = 0; done < out.size(); done += kStep) {
    const std::size_t size = std::min(kStep, out.size() - done);
    const auto address = static_cast<std::uint32_t>(kFlashBase + begin + done);
    MIXRIG_TRY(bootloader.read(address, out.subspan(done, size)));
    progress(what, done + size, out.size());
  }
  return {};
}

/// A UART carries no check sum of what is read: a difference must stay one when looked at again.
Result<void> verify_range(Bootloader& bootloader, std::span<const std::uint8_t> bytes,
                          std::size_t begin, std::size_t end, const FlashProgress& progress) {
  std::array<std::uint8_t, kStep> got;
  for (std::size_t at = begin; at < end; at += kStep) {
    const std::size_t size = std::min(kStep, end - at);
    const auto wanted = bytes.subspan(at, size);
    const auto here = std::span(got).first(size);
    bool same = false;
    for (int i = 0; i < kReadTries && !same; ++i) {
      MIXRIG_TRY(bootloader.read(static_cast<std::uint32_t>(kFlashBase + at), here));
      same = std::equal(wanted.begin(), wanted.end(), here.begin());
    }
    if (!same) {
      const auto differs = std::mismatch(wanted.begin(), wanted.end(), here.begin()).first;
      const auto address = kFlashBase + at + static_cast<std::size_t>(differs - wanted.begin());
      char text[16];
      std::snprintf(text, sizeof text, "0x%08zx", address);
      return Error{ErrorCode::kData, std::string("flash differs from the image at ") + text};
    }
    progress("verify", at + size - begin, end - begin);
  }
  return {};
}

Result<void> write_range(Bootloader& bootloader, std::span<const std::uint8_t> bytes,
                         std::size_t begin, std::size_t end, const FlashProgress& progress) {
  for (std::size_t at = begin; at < end; at += kVectorBlock) {
    const std::size_t size = std::min(kVectorBlock, end - at);
    const auto address = static_cast<std::uint32_t>(kFlashBase + at);
    MIXRIG_TRY(bootloader.write(address, bytes.subspan(at, size)));
    progress("write", at + size - begin, end - begin);
  }
  return verify_range(bootloader, bytes, begin, end, progress);
}

Result<void> rewrite(Bootloader& bootloader, const std::vector<FlashSector>& sectors,
                     std::span<const std::uint8_t> bytes, const FlashProgress& progress) {
  const std::size_t size = bytes.size();
  std::size_t erased = 0;
  // The vectors' sector goes first: from here on the old image does not boot either.
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
  MIXRIG_TRY(read_range(bootloader, 0, previous.bytes, "read old image", progress));
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
  MIXRIG_TRY(read_range(bootloader, 0, previous.bytes, "read old image", progress));
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
  if (auto done = rewrite(bootloader, sectors, bytes, progress); !done) {
    return unfinished(done.error());
  }
  return {};
}

Result<void> verify_flash(Bootloader& bootloader, std::span<const std::uint8_t> bytes,
                          const FlashProgress& progress) {
  return verify_range(bootloader, bytes, 0, bytes.size(), progress);
}

Result<void> enter_bootloader(ByteStream& stream, Clock& clock, const std::string& name) {
  Stm32Rom rom(stream, clock);
  MIXRIG_ASSIGN(const bool there, rom.answers());
  if (there) return {};
  MIXRIG_TRY(stream.set_line({}));
  protocol::Verdict verdict = protocol::Verdict::kOk;
  McuLink link(stream, clock, name);
  const McuLink::Patience patience{std::chrono::milliseconds(100), 10};
  const protocol::Reboot reboot{protocol::RebootTarget::kBootloader, protocol::kRebootKey};
  auto asked = link.ask(reboot, patience, nullptr, &verdict);
  if (!asked && asked.error().code == ErrorCode::kTimeout) {
    return Error{ErrorCode::kTimeout, "neither firmware nor bootloader answers at " + name +
                                          ": check cable and power, or hold BOOT0 at reset"};
  }
  if (!asked) return std::move(asked).error();
  if (verdict == protocol::Verdict::kState) {
    return Error{ErrorCode::kDevice,
                 "triggers are running at " + name + ": stop them first (mixrig trigger stop)"};
  }
  if (verdict != protocol::Verdict::kOk) {
    return Error{ErrorCode::kDevice, "trigger controller at " + name + " " + meaning(verdict)};
  }
  return {};
}

}  // namespace mixrig::device

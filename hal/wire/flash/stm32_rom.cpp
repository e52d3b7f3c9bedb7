// SPDX-License-Identifier: Apache-2.0
#include "hal/wire/flash/stm32_rom.h"

#include <algorithm>
#include <array>
#include <string>

#include <fmt/format.h>

namespace mixrig::device {

using std::chrono::milliseconds;
using std::chrono::seconds;

namespace {

constexpr std::uint8_t kAck = 0x79;
constexpr std::uint8_t kNack = 0x1F;
constexpr std::uint8_t kSync = 0x7F;
/// Fill byte. No command begins with it, and repetitions of it never form a valid checksum wherever
/// a command was interrupted: read as the size of a write it requires an odd number of data bytes,
/// so that the XOR is not zero. (Repeated 0x7F, read as size, data and checksum, would be written.)
constexpr std::uint8_t kFill = 0x04;
constexpr std::uint8_t kGetId = 0x02;
constexpr std::uint8_t kRead = 0x11;
constexpr std::uint8_t kGo = 0x21;
constexpr std::uint8_t kWrite = 0x31;
constexpr std::uint8_t kExtendedErase = 0x44;
constexpr std::uint16_t kF405 = 0x413;

constexpr Duration kAckTimeout = milliseconds(500);
constexpr Duration kEraseTimeout = seconds(5);  // 128 KiB: at most 2 s according to the data sheet
constexpr Duration kQuiet = milliseconds(20);   // longer than a USB adapter buffers bytes
constexpr std::size_t kBlock = Stm32Rom::kLongestBlock;
constexpr std::size_t kShortestBlock = 16;
constexpr int kGrowAfter = 8;
constexpr std::size_t kLongestList = 2u * 0x10000;  // bytes of the longest list of sectors to erase
constexpr int kConnectTries = 15;  // 3 s: firmware may just be starting the bootloader
constexpr int kTries = 32;         // with 1 % of bytes damaged, 2/3 of the shortest blocks pass

std::string hex(std::uint32_t value) { return fmt::format("{:#x}", value); }

std::uint8_t xor_of(std::span<const std::uint8_t> bytes) {
  std::uint8_t sum = 0;
  for (const std::uint8_t byte : bytes) sum ^= byte;
  return sum;
}

Error refused(const std::string& what) {
  return Error{ErrorCode::kDevice, "bootloader refused to " + what};
}

/// Returns the sectors by RM0090 table 5: 4 x 16, 64, 7 x 128 KiB.
std::vector<FlashSector> f405_sectors() {
  std::vector<FlashSector> sectors;
  std::uint32_t address = 0x08000000;
  for (int i = 0; i < 12; ++i) {
    const std::uint32_t size = (i < 4 ? 16u : i == 4 ? 64u : 128u) * 1024u;
    sectors.push_back({address, size});
    address += size;
  }
  return sectors;
}

}  // namespace

Result<void> Stm32Rom::send(Bytes bytes) { return stream_.write(bytes); }

Result<void> Stm32Rom::receive(std::span<std::uint8_t> out, Duration timeout) {
  const HostTime deadline = clock_.now() + timeout;
  while (!out.empty()) {
    const Duration left = deadline - clock_.now();
    if (left <= Duration{0}) {
      return Error{ErrorCode::kTimeout, "bootloader does not answer"};
    }
    MIXRIG_ASSIGN(const std::size_t n, stream_.read(out, left));
    out = out.subspan(n);
  }
  return {};
}

/// Reads until the line is quiet: the rest of an interrupted answer may still arrive.
void Stm32Rom::discard_input() {
  std::array<std::uint8_t, 256> waste;
  for (int i = 0; i < 64; ++i) {
    const auto n = stream_.read(waste, kQuiet);
    if (!n || *n == 0) return;
  }
}

Result<void> Stm32Rom::await_ack(const char* what, Duration timeout) {
  std::uint8_t answer = 0;
  if (auto got = receive({&answer, 1}, timeout); !got) {
    if (got.error().code != ErrorCode::kTimeout) return got;
    return Error{ErrorCode::kTimeout,
                 std::string("bootloader does not answer to ") + what + ": power or cable lost?"};
  }
  if (answer == kAck) return {};
  if (answer == kNack) return refused(what);
  return Error{ErrorCode::kDevice, std::string("bootloader answered ") + what + " with " +
                                       hex(answer) + ": noise on the line, or parity"};
}

Result<void> Stm32Rom::command(std::uint8_t code, const char* what) {
  const std::array<std::uint8_t, 2> bytes = {code, static_cast<std::uint8_t>(~code)};
  MIXRIG_TRY(send(bytes));
  return await_ack(what, kAckTimeout);
}

Result<void> Stm32Rom::send_address(std::uint32_t address, const char* what) {
  std::array<std::uint8_t, 5> bytes{};
  for (std::size_t i = 0; i < 4; ++i) {
    bytes[i] = static_cast<std::uint8_t>(address >> (24 - 8 * i));
  }
  bytes[4] = xor_of(std::span(bytes).first(4));
  MIXRIG_TRY(send(bytes));
  return await_ack(what, kAckTimeout);
}

Result<bool> Stm32Rom::answers() {
  MIXRIG_TRY(stream_.set_line({115'200, Parity::kEven}));
  discard_input();
  MIXRIG_TRY(send(std::array<std::uint8_t, 1>{kSync}));
  const HostTime deadline = clock_.now() + milliseconds(200);
  std::uint8_t answer = 0;
  while (clock_.now() < deadline) {
    MIXRIG_ASSIGN(const std::size_t n, stream_.read({&answer, 1}, deadline - clock_.now()));
    // NACK: it was synchronised before. Firmware may be in the middle of a report: read on.
    if (n == 1 && (answer == kAck || answer == kNack)) {
      for (int i = 0; i < 3; ++i) {
        if (read_chip_id()) return true;
      }
    }
  }
  return false;
}

Result<std::uint16_t> Stm32Rom::read_chip_id() {
  std::array<std::uint8_t, 3> id{};
  MIXRIG_TRY(command(kGetId, "report its chip"));
  MIXRIG_TRY(receive(id, kAckTimeout));
  MIXRIG_TRY(await_ack("report its chip", kAckTimeout));
  if (id[0] != 1) return refused("report its chip in the known format");
  return static_cast<std::uint16_t>(id[1] << 8 | id[2]);
}

Result<BootloaderInfo> Stm32Rom::connect() {
  bool found = false;
  for (int i = 0; i < kConnectTries && !found; ++i) {
    MIXRIG_ASSIGN(found, answers());
  }
  if (!found) {
    return Error{ErrorCode::kTimeout,
                 "no bootloader answers: hold BOOT0 high, press reset, and try again"};
  }
  std::uint16_t chip = 0;
  MIXRIG_TRY(repeat([&]() -> Result<void> {
    MIXRIG_ASSIGN(chip, read_chip_id());
    MIXRIG_ASSIGN(const std::uint16_t again, read_chip_id());
    if (chip == again) return {};
    return Error{ErrorCode::kDevice,
                 "bootloader reports a different chip each time: noise on the line?"};
  }));
  if (chip != kF405) {
    return Error{ErrorCode::kDevice, "wrong board: chip " + hex(chip) + ", an STM32F405 is " +
                                         hex(kF405) + "; nothing was erased"};
  }
  sectors_ = f405_sectors();
  return BootloaderInfo{"STM32 ROM bootloader over UART, chip " + hex(chip), chip, sectors_};
}

/// Sends bursts of fill bytes until one is refused; false where none was.
Result<bool> Stm32Rom::fill_until_refused(std::size_t bursts, std::size_t size) {
  std::array<std::uint8_t, kBlock> fill;
  fill.fill(kFill);
  for (std::size_t i = 0; i < bursts; ++i) {
    MIXRIG_TRY(send(std::span(fill).first(size)));
    std::uint8_t answer = 0;
    MIXRIG_ASSIGN(const std::size_t n, stream_.read({&answer, 1}, milliseconds(5)));
    if (n == 1 && answer == kNack) return true;
  }
  return false;
}

/// Makes the bootloader wait for a command: it does so after a refusal; otherwise it may still wait
/// for the rest of one.
Result<void> Stm32Rom::resynchronize(std::size_t longest) {
  discard_input();
  MIXRIG_ASSIGN(bool refused, fill_until_refused(kLongestCommand, 1));
  if (!refused && longest > kLongestCommand) {
    MIXRIG_ASSIGN(const bool list_refused, fill_until_refused(longest / kBlock, kBlock));
    discard_input();
    MIXRIG_ASSIGN(refused, list_refused ? fill_until_refused(kLongestCommand, 1) : false);
  }
  if (refused) return {};
  return Error{ErrorCode::kTimeout, "bootloader does not answer any more: power or cable lost?"};
}

/// Adapts the block size. Long blocks are fast; short ones pass a noisy line more often. On a noisy
/// line a damaged long block also passes the one-byte checksum more often.
void Stm32Rom::adapt_block(bool passed) {
  passed_in_a_row_ = passed ? passed_in_a_row_ + 1 : 0;
  if (!passed) block_ = std::max(block_ / 2, kShortestBlock);
  if (passed_in_a_row_ == kGrowAfter) {
    passed_in_a_row_ = 0;
    block_ = std::min(2 * block_, kBlock);
  }
}

Result<void> Stm32Rom::repeat(const std::function<Result<void>()>& operation, std::size_t longest) {
  Result<void> result = operation();
  for (int i = 1; i < kTries && !result; ++i) {
    const bool gone = result.error().sys_errno != 0;
    if (gone) return result;
    ++repeats_;
    MIXRIG_TRY(resynchronize(longest));
    result = operation();
  }
  return result;
}

Result<void> Stm32Rom::read_block(std::uint32_t address, std::span<std::uint8_t> out) {
  constexpr const char* kWhat = "read flash (read protection?)";
  MIXRIG_TRY(command(kRead, kWhat));
  MIXRIG_TRY(send_address(address, kWhat));
  const auto count = static_cast<std::uint8_t>(out.size() - 1);
  MIXRIG_TRY(send(std::array<std::uint8_t, 2>{count, static_cast<std::uint8_t>(~count)}));
  MIXRIG_TRY(await_ack(kWhat, kAckTimeout));
  return receive(out, seconds(1));
}

Result<void> Stm32Rom::write_block(std::uint32_t address, Bytes data) {
  constexpr const char* kWhat = "write flash (write protection?)";
  std::array<std::uint8_t, kBlock + 2> bytes;
  const std::size_t size = data.size();
  bytes[0] = static_cast<std::uint8_t>(size - 1);
  std::copy(data.begin(), data.end(), bytes.begin() + 1);
  bytes[size + 1] = xor_of(std::span(bytes).first(size + 1));
  MIXRIG_TRY(command(kWrite, kWhat));
  MIXRIG_TRY(send_address(address, kWhat));
  MIXRIG_TRY(send(std::span(bytes).first(size + 2)));
  return await_ack(kWhat, seconds(1));
}

Result<void> Stm32Rom::read(std::uint32_t address, std::span<std::uint8_t> out) {
  while (!out.empty()) {
    std::size_t size = 0;
    MIXRIG_TRY(repeat([&] {
      size = std::min(out.size(), block_);
      auto result = read_block(address, out.first(size));
      adapt_block(static_cast<bool>(result));
      return result;
    }));
    address += static_cast<std::uint32_t>(size);
    out = out.subspan(size);
  }
  return {};
}

Result<void> Stm32Rom::write(std::uint32_t address, std::span<const std::uint8_t> data) {
  while (!data.empty()) {
    std::size_t size = 0;
    MIXRIG_TRY(repeat([&] {
      size = std::min(data.size(), block_);
      auto result = write_block(address, data.first(size));
      adapt_block(static_cast<bool>(result));
      return result;
    }));
    address += static_cast<std::uint32_t>(size);
    data = data.subspan(size);
  }
  return {};
}

Result<void> Stm32Rom::erase_sector(int sector) {
  constexpr const char* kWhat = "erase flash (write protection?)";
  const std::array<std::uint8_t, 4> list = {0, 0, 0, static_cast<std::uint8_t>(sector)};
  MIXRIG_TRY(command(kExtendedErase, kWhat));
  MIXRIG_TRY(send(list));
  MIXRIG_TRY(send(std::array<std::uint8_t, 1>{xor_of(list)}));
  return await_ack(kWhat, kEraseTimeout);
}

Result<void> Stm32Rom::erase(const FlashSector& sector) {
  const auto found = std::find(sectors_.begin(), sectors_.end(), sector);
  if (found == sectors_.end()) return refused("erase " + hex(sector.address) + ": no such sector");
  const auto index = static_cast<int>(found - sectors_.begin());
  // If the count is damaged, the bootloader waits for a long list of sectors.
  return repeat([&] { return erase_sector(index); }, kLongestList);
}

Result<void> Stm32Rom::go(std::uint32_t address) {
  constexpr const char* kWhat = "start the program";
  bool sent = false;
  auto done = repeat([&]() -> Result<void> {
    MIXRIG_TRY(command(kGo, kWhat));
    sent = true;
    return send_address(address, kWhat);
  });
  // The last acknowledge was lost: the started program does not answer like a bootloader.
  if (!done && sent && done.error().code == ErrorCode::kTimeout) return {};
  return done;
}

}  // namespace mixrig::device

// SPDX-License-Identifier: Apache-2.0
// The contract of Bootloader, over UART and over USB.
#include <functional>
#include <memory>
#include <numeric>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hal/fake/emulated_board.h"
#include "hal/fake/emulated_dfuse.h"
#include "hal/wire/flash/dfuse.h"
#include "hal/wire/flash/stm32_rom.h"

namespace mixrig::test {
namespace {

constexpr std::uint32_t kFlash = fake::EmulatedFlash::kBase;

struct BootloaderUnderTest {
  std::shared_ptr<void> keep;  ///< what must outlive the bootloader
  std::unique_ptr<device::Bootloader> bootloader;
  fake::EmulatedFlash* flash = nullptr;
  std::function<std::optional<std::uint32_t>()> gone_to;
};

struct BootloaderMaker {
  std::string name;
  std::function<BootloaderUnderTest()> make;
  friend void PrintTo(const BootloaderMaker& maker, std::ostream* out) { *out << maker.name; }
};

BootloaderUnderTest make_uart() {
  struct Bench {
    ManualClock clock;
    fake::EmulatedBoard board;
    fake::BoardStream stream{board, clock};
  };
  auto bench = std::make_shared<Bench>();
  bench->board.power_cycle(true);
  return {bench, std::make_unique<device::Stm32Rom>(bench->stream, bench->clock),
          &bench->board.flash(), [bench] { return bench->board.rom().gone_to(); }};
}

BootloaderUnderTest make_usb() {
  struct Bench {
    ManualClock clock;
    fake::EmulatedFlash flash;
    fake::EmulatedDfuse usb{flash};
  };
  auto bench = std::make_shared<Bench>();
  return {bench, std::make_unique<device::Dfuse>(bench->usb, bench->clock), &bench->flash,
          [bench] { return bench->usb.gone_to(); }};
}

class BootloaderContract : public ::testing::TestWithParam<BootloaderMaker> {
 protected:
  void SetUp() override {
    under_test_ = GetParam().make();
    auto info = boot().connect();
    ASSERT_TRUE(info) << to_line(info.error());
    info_ = *std::move(info);
  }
  device::Bootloader& boot() { return *under_test_.bootloader; }
  fake::EmulatedFlash& flash() { return *under_test_.flash; }
  std::vector<std::uint8_t> read(std::uint32_t address, std::size_t size) {
    std::vector<std::uint8_t> bytes(size);
    const auto done = boot().read(address, bytes);
    EXPECT_TRUE(done) << to_line(done.error());
    return bytes;
  }
  static std::vector<std::uint8_t> counting(std::size_t size) {
    std::vector<std::uint8_t> bytes(size);
    std::iota(bytes.begin(), bytes.end(), std::uint8_t{1});
    return bytes;
  }

  BootloaderUnderTest under_test_;
  device::BootloaderInfo info_;
};

TEST_P(BootloaderContract, ConnectReturnsTheSectorsOfTheChip) {
  EXPECT_FALSE(info_.name.empty());
  ASSERT_EQ(info_.sectors.size(), 12U);
  std::uint32_t next = kFlash;
  for (const device::FlashSector& sector : info_.sectors) {
    EXPECT_EQ(sector.address, next);
    next += sector.size;
  }
  EXPECT_EQ(next, kFlash + fake::EmulatedFlash::kSize);
  EXPECT_TRUE(boot().connect()) << "may be repeated";
}

TEST_P(BootloaderContract, ReadsBackWhatWasWrittenInAnyLength) {
  std::uint32_t address = kFlash + 4;
  for (const std::size_t size : {4U, 252U, 256U, 260U, 2048U, 2052U, 5000U}) {
    const auto bytes = counting(size);
    const auto done = boot().write(address, bytes);
    ASSERT_TRUE(done) << size << ": " << to_line(done.error());
    EXPECT_EQ(read(address, size), bytes) << size;
    address += static_cast<std::uint32_t>(size) + 4;
  }
  EXPECT_EQ(read(kFlash, 4), std::vector<std::uint8_t>(4, 0xFF));
  EXPECT_EQ(read(kFlash + 1, 3), std::vector<std::uint8_t>(3, 0xFF)) << "reads at any address";
}

TEST_P(BootloaderContract, ErasesTheGivenSectorAndNoOther) {
  flash().load(std::vector<std::uint8_t>(128 * 1024, 0x55));
  const device::FlashSector& sector = info_.sectors[1];
  ASSERT_TRUE(boot().erase(sector));
  EXPECT_EQ(read(sector.address - 4, 4), std::vector<std::uint8_t>(4, 0x55));
  EXPECT_EQ(read(sector.address, sector.size), std::vector<std::uint8_t>(sector.size, 0xFF));
  EXPECT_EQ(read(sector.address + sector.size, 4), std::vector<std::uint8_t>(4, 0x55));
  EXPECT_FALSE(boot().erase({sector.address, 1}));
  EXPECT_FALSE(boot().erase({kFlash + fake::EmulatedFlash::kSize, 16 * 1024}));
  EXPECT_EQ(flash().changes(), 1);
}

TEST_P(BootloaderContract, RefusesAddressesOutsideOfFlashAndContinues) {
  const auto four = counting(4);
  std::vector<std::uint8_t> got(4);
  for (const std::uint32_t address : {0x40000000U, kFlash + fake::EmulatedFlash::kSize,
                                      kFlash + fake::EmulatedFlash::kSize - 2}) {
    EXPECT_FALSE(boot().write(address, four)) << address;
    EXPECT_FALSE(boot().read(address, got)) << address;
  }
  EXPECT_EQ(flash().changes(), 0);
  ASSERT_TRUE(boot().connect());
  EXPECT_TRUE(boot().write(kFlash, four));
  EXPECT_EQ(read(kFlash, 4), four);
}

TEST_P(BootloaderContract, StartsTheProgram) {
  ASSERT_TRUE(boot().go(kFlash));
  EXPECT_EQ(under_test_.gone_to(), kFlash);
  EXPECT_FALSE(boot().connect()) << "the bootloader does not run any more";
}

INSTANTIATE_TEST_SUITE_P(All, BootloaderContract,
                         ::testing::Values(BootloaderMaker{"uart", make_uart},
                                           BootloaderMaker{"usb", make_usb}),
                         [](const auto& maker) { return maker.param.name; });

}  // namespace
}  // namespace mixrig::test

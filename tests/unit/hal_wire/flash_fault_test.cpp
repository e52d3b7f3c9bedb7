// SPDX-License-Identifier: Apache-2.0
// Failures of flashing: at every answer, at every change of flash, on wrong boards.
#include <cstdio>

#include <gtest/gtest.h>

#include "flash_board.h"

namespace mixrig::device {
namespace {

const std::vector<std::uint8_t> kOld = make_image(5000, 1);
const std::vector<std::uint8_t> kNew = make_image(5200, 2);

TEST(FlashFault, one_nack_at_any_step_is_repeated_and_done) {
  int steps = 0;
  for (int nack = 1; nack < 10'000; ++nack) {
    FlashBoard b;
    b.board.flash().load(kOld);
    b.board.power_cycle(true);
    b.board.rom().nack_at(nack);
    const auto done = b.flash(kNew);
    ASSERT_TRUE(done) << "answer " << nack << ": " << to_line(done.error());
    ASSERT_TRUE(b.holds(kNew)) << nack;
    if (b.board.rom().answers() < nack) break;
    steps = nack;
  }
  EXPECT_GT(steps, 100);
  RecordProperty("steps", steps);
}

TEST(FlashFault, power_loss_at_every_change_never_boots_a_partial_image_and_is_recovered) {
  int changes = 0;
  for (int change = 1; change < 10'000; ++change) {
    FlashBoard b;
    b.board.flash().load(kOld);
    b.board.power_cycle(false);
    b.board.flash().fail_power_at(change);
    const auto cut = b.flash(kNew);
    if (b.board.flash().powered()) {  // no such change: flashing was complete
      ASSERT_TRUE(cut);
      break;
    }
    changes = change;
    ASSERT_FALSE(cut);
    EXPECT_NE(cut.error().context.find("flash again, with BOOT0 held"), std::string::npos)
        << cut.error().context;
    ASSERT_FALSE(b.boots_partial_image(kOld, kNew)) << "change " << change;
    b.board.power_cycle(true);
    const auto again = b.flash(kNew);
    ASSERT_TRUE(again) << to_line(again.error());
    ASSERT_TRUE(b.holds(kNew));
  }
  EXPECT_GE(changes, 1 + 22);  // the erase and every block
}

TEST(FlashFault, partial_image_with_vectors_reports_itself_as_damaged) {
  // Writing the vectors last prevents this case; the firmware's own check must detect it too.
  FlashBoard b;
  auto half = kNew;
  std::fill(half.begin() + 3000, half.end(), std::uint8_t{0xFF});
  b.board.flash().load(half);
  b.board.power_cycle(false);
  ASSERT_EQ(b.board.mode(), fake::BoardMode::kFirmware);
  McuLink link(b.stream, b.clock, "test");
  const auto hello = link.ask(protocol::Hello{protocol::kTableHash});
  ASSERT_TRUE(hello);
  EXPECT_EQ(hello->image_ok, 0);
  EXPECT_FALSE(link.ask(protocol::Arm{}));
}

TEST(FlashFault, wrong_chip_is_refused_before_anything_is_erased) {
  FlashBoard b;
  b.board.flash().load(kOld);
  b.board.power_cycle(true);
  b.board.rom().chip_id = 0x410;
  const auto done = b.flash(kNew);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().context,
            "wrong board: chip 0x410, an STM32F405 is 0x413; nothing was erased");
  EXPECT_EQ(b.board.flash().changes(), 0);
}

TEST(FlashFault, worn_cell_is_found_by_reading_back) {
  FlashBoard b;
  auto image = kNew;
  image[4001] |= 1;
  stamp(image, good_header());
  b.board.power_cycle(true);
  b.board.flash().wear_out(protocol::kFlashBase + 4001);
  const auto done = b.flash(image);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().context,
            "flash differs from the image at 0x08000fa1; the board will not boot now: flash again, "
            "with BOOT0 held at reset");
  b.board.power_cycle(false);
  EXPECT_EQ(b.board.mode(), fake::BoardMode::kNothing);
}

TEST(FlashFault, running_triggers_are_not_interrupted) {
  FlashBoard b;
  b.board.flash().load(kOld);
  b.board.power_cycle(false);
  McuLink link(b.stream, b.clock, "test");
  ASSERT_TRUE(link.ask(protocol::Hello{protocol::kTableHash}));
  ASSERT_TRUE(link.ask(protocol::Arm{}));
  ASSERT_TRUE(link.ask(protocol::Start{}));
  const auto done = b.flash(kNew);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().context,
            "triggers are running at test: stop them first (mixrig trigger stop)");
  EXPECT_EQ(b.board.flash().changes(), 0);
}

TEST(FlashFault, dead_board_is_one_line) {
  FlashBoard b;
  b.board.power_cycle(false);
  const auto done = b.flash(kNew);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, ErrorCode::kTimeout);
  EXPECT_EQ(done.error().context,
            "neither firmware nor bootloader answers at test: check cable and power, or hold BOOT0 "
            "at reset");
}

TEST(FlashFault, firmware_of_another_version_can_be_flashed) {
  // An emulated board always has this message table: here the host's Hello differs instead.
  FlashBoard b;
  b.board.flash().load(kOld);
  b.board.power_cycle(false);
  McuLink link(b.stream, b.clock, "test");
  EXPECT_FALSE(link.ask(protocol::Hello{protocol::kTableHash ^ 7}));
  ASSERT_TRUE(b.flash(kNew));
  EXPECT_TRUE(b.holds(kNew));
}

/// The whole of `mixrig flash` on a line that damages one byte in a hundred, either way.
TEST(FlashFault,
     works_with_one_percent_of_bytes_damaged_from_running_firmware_to_running_firmware) {
  int repeats = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    FlashBoard b;
    b.board.flash().load(kOld);
    b.board.power_cycle(false);
    b.stream.reseed(seed);
    b.stream.line.byte_error_share = 0.01;
    const auto entered = enter_bootloader(b.stream, b.clock, "test");
    ASSERT_TRUE(entered) << seed << ": " << to_line(entered.error());
    const auto info = b.rom.connect();
    ASSERT_TRUE(info) << seed << ": " << to_line(info.error());
    const auto previous = read_previous(b.rom, *info, kNew.size(), b.quiet);
    ASSERT_TRUE(previous) << seed << ": " << to_line(previous.error());
    ASSERT_EQ(previous->bytes, kOld) << seed;
    const auto written = write_flash(b.rom, *info, kNew, b.quiet);
    ASSERT_TRUE(written) << seed << ": " << to_line(written.error());
    ASSERT_TRUE(b.holds(kNew)) << seed;
    ASSERT_TRUE(b.rom.go(protocol::kFlashBase)) << seed;
    ASSERT_TRUE(b.stream.set_line({}));
    McuLink link(b.stream, b.clock, "test");
    const auto hello = link.ask(protocol::Hello{protocol::kTableHash});
    ASSERT_TRUE(hello) << seed << ": " << to_line(hello.error());
    ASSERT_EQ(hello->image_ok, 1) << seed;
    repeats += b.rom.repeats();
  }
  EXPECT_GT(repeats, 40);
  std::printf("1 %% of bytes damaged: 40 of 40 flashed, %d commands repeated\n", repeats);
}

TEST(FlashFault, too_noisy_line_is_an_error_and_never_a_false_success) {
  int failed = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    FlashBoard b;
    b.board.flash().load(kOld);
    b.board.power_cycle(true);
    b.stream.reseed(seed);
    b.stream.line.byte_error_share = 0.15;
    const auto done = b.flash(kNew);
    failed += !done;
    ASSERT_TRUE(!done || b.holds(kNew)) << seed;
    ASSERT_FALSE(b.boots_partial_image(kOld, kNew)) << seed;
  }
  EXPECT_GT(failed, 0);
}

}  // namespace
}  // namespace mixrig::device

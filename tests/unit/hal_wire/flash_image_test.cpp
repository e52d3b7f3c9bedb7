// SPDX-License-Identifier: Apache-2.0
// Flashing over the UART bootloader without faults.
#include "hal/wire/flash/flash_image.h"

#include <string>

#include <gtest/gtest.h>

#include "flash_board.h"

namespace mixrig::device {
namespace {

struct Flash : ::testing::Test, FlashBoard {
  std::vector<std::uint8_t> image = make_image(8800, 1);
};

TEST_F(Flash, empty_board_boots_the_image) {
  board.power_cycle(true);
  const auto done = flash(image);
  ASSERT_TRUE(done) << to_line(done.error());
  EXPECT_TRUE(holds(image));
  EXPECT_EQ(rom.repeats(), 0);
  std::uint8_t waste[1];
  ASSERT_TRUE(stream.read(waste, Duration{0}));
  EXPECT_EQ(board.mode(), fake::BoardMode::kFirmware);
}

TEST_F(Flash, running_firmware_starts_the_bootloader) {
  board.flash().load(make_image(5000, 2));
  board.power_cycle(false);
  ASSERT_EQ(board.mode(), fake::BoardMode::kFirmware);
  const auto done = flash(image);
  ASSERT_TRUE(done) << to_line(done.error());
  EXPECT_TRUE(holds(image));
}

TEST_F(Flash, bootloader_gets_even_parity_and_0x7f_first) {
  board.power_cycle(true);
  ASSERT_TRUE(rom.connect());
  EXPECT_EQ(stream.settings.parity, Parity::kEven);
  EXPECT_TRUE(board.rom().synchronized());
}

TEST_F(Flash, vectors_are_written_last) {
  board.power_cycle(true);
  const auto info = *rom.connect();
  bool vectors_blank_until_end = true;
  const FlashProgress watch = [&](const char* what, std::size_t done, std::size_t total) {
    const bool last_write = total <= protocol::kVectorBlock;
    if (std::string(what) == "write" && !last_write && done < total) {
      vectors_blank_until_end &= board.flash().bytes()[0] == 0xFF;
    }
  };
  ASSERT_TRUE(write_flash(rom, info, image, watch));
  EXPECT_TRUE(vectors_blank_until_end);
}

TEST_F(Flash, only_the_sectors_under_the_image_are_erased) {
  std::vector<std::uint8_t> marked(64 * 1024, 0xAA);
  board.flash().load(marked);
  board.power_cycle(true);
  ASSERT_TRUE(flash(image));
  EXPECT_EQ(board.flash().bytes()[16 * 1024], 0xAA);
  EXPECT_EQ(board.flash().bytes()[8800], 0xFF);
}

TEST_F(Flash, large_image_crosses_sectors) {
  const auto large = make_image(100 * 1024, 3);
  board.power_cycle(true);
  ASSERT_TRUE(flash(large));
  EXPECT_TRUE(holds(large));
}

TEST_F(Flash, previous_image_is_read_byte_for_byte) {
  const auto old = make_image(5000, 4);
  board.flash().load(old);
  board.power_cycle(true);
  const auto info = rom.connect();
  ASSERT_TRUE(info);
  const auto previous = read_previous(rom, *info, image.size(), quiet);
  ASSERT_TRUE(previous);
  EXPECT_EQ(previous->bytes, old);
  ASSERT_TRUE(write_flash(rom, *info, image, quiet));
  ASSERT_TRUE(write_flash(rom, *info, previous->bytes, quiet));
  EXPECT_TRUE(holds(old));
}

TEST_F(Flash, previous_of_a_blank_board_is_empty_and_of_another_program_all_sectors) {
  board.power_cycle(true);
  const auto info = rom.connect();
  EXPECT_TRUE(read_previous(rom, *info, image.size(), quiet)->blank);
  std::vector<std::uint8_t> foreign(3000, 0x42);
  board.flash().load(foreign);
  const auto previous = read_previous(rom, *info, image.size(), quiet);
  ASSERT_FALSE(previous->blank);
  EXPECT_EQ(previous->bytes.size(), 16u * 1024);
}

TEST_F(Flash, verify_reports_the_first_address_that_differs) {
  board.flash().load(image);
  board.power_cycle(true);
  ASSERT_TRUE(rom.connect());
  EXPECT_TRUE(verify_flash(rom, image, quiet));
  auto other = image;
  other[5001] ^= 1;
  const auto result = verify_flash(rom, other, quiet);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kData);
  EXPECT_EQ(result.error().context, "flash differs from the image at 0x08001389");
}

TEST_F(Flash, image_that_does_not_fit_erases_nothing) {
  board.power_cycle(true);
  const auto info = rom.connect();
  const int before = board.flash().changes();
  EXPECT_FALSE(write_flash(rom, *info, std::vector<std::uint8_t>(2 * 1024 * 1024), quiet));
  EXPECT_EQ(board.flash().changes(), before);
}

TEST_F(Flash, writes_respect_the_limits_of_the_real_rom) {
  board.power_cycle(true);
  ASSERT_TRUE(rom.connect());
  std::uint8_t byte[4] = {};
  EXPECT_FALSE(rom.read(0x40000000, byte));
  EXPECT_FALSE(rom.write(0x08000002, byte));
  EXPECT_FALSE(rom.erase({0x08000000, 1}));
}

}  // namespace
}  // namespace mixrig::device

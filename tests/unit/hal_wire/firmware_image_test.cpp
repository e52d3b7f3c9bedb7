// SPDX-License-Identifier: Apache-2.0
// Which files are accepted as an image.
#include "hal/wire/flash/firmware_image.h"

#include <cstring>

#include <gtest/gtest.h>

#include "tests/support/make_image.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::device {
namespace {

std::string reason(std::vector<std::uint8_t> bytes, ImageRules rules = {}) {
  const auto image = check_image(std::move(bytes), "x.bin", rules);
  return image ? "" : image.error().context;
}

TEST(FirmwareImage, valid_image_is_accepted) {
  const auto image = check_image(make_image(4096, 1), "x.bin");
  ASSERT_TRUE(image);
  EXPECT_EQ(version_text(image->header), "0.1.0");
}

TEST(FirmwareImage, truncated_at_any_length_is_refused) {
  const auto whole = make_image(2048, 1);
  for (std::size_t n = 0; n < whole.size(); ++n) {
    ASSERT_NE(reason({whole.begin(), whole.begin() + static_cast<long>(n)}), "") << n;
  }
  EXPECT_EQ(reason({whole.begin(), whole.begin() + 1024}),
            "x.bin: image says 2048 bytes, file has 1024: truncated or not stamped; nothing was "
            "erased");
}

TEST(FirmwareImage, any_changed_byte_is_detected) {
  const auto whole = make_image(1024, 2);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    auto changed = whole;
    changed[i] ^= 0x40;
    ASSERT_NE(reason(changed), "") << i;
  }
}

TEST(FirmwareImage, wrong_board_and_wrong_protocol_are_named) {
  auto image = make_image(1024, 3);
  auto header = good_header();
  header.board = 103;
  stamp(image, header);
  EXPECT_NE(reason(image).find("is for board 103, this one is 405"), std::string::npos);
  header = good_header();
  header.table_hash ^= 1;
  stamp(image, header);
  EXPECT_NE(reason(image).find("uses another protocol"), std::string::npos);
  EXPECT_EQ(reason(image, {.this_protocol = false}), "");
}

TEST(FirmwareImage, other_files_are_no_images) {
  EXPECT_NE(reason({}).find("no mixrig trigger image"), std::string::npos);
  EXPECT_NE(reason(std::vector<std::uint8_t>(4096, 0xFF)).find("no mixrig trigger image"),
            std::string::npos);
}

TEST(FirmwareImage, files_are_read_back_as_written_and_leave_nothing_else) {
  const test::TemporaryFolder folder;
  const auto image = make_image(1024, 4);
  const std::string path = folder / "a/b/kept.bin";
  ASSERT_TRUE(write_image_file(path, image));
  EXPECT_EQ(load_image(path)->bytes, image);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder / "a/b"), {}), 1);
}

TEST(FirmwareImage, missing_and_too_large_files_are_errors) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(load_image(folder / "none").error().code, ErrorCode::kNotFound);
  const auto giant = folder.write("giant", std::string(protocol::kMaxImage + 1, 'x'));
  EXPECT_EQ(load_image(giant).error().code, ErrorCode::kFormat);
}

TEST(FirmwareImage, unwritable_place_is_an_error_and_leaves_no_file) {
  const test::TemporaryFolder folder;
  const std::string blocked = folder.write("file", "x");
  EXPECT_FALSE(write_image_file(blocked + "/kept.bin", make_image(1024, 5)));
}

}  // namespace
}  // namespace mixrig::device

// SPDX-License-Identifier: Apache-2.0
// Matroska streams that are missing, cut short or damaged: an error, never an endless wait.
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"
#include "tests/unit/take/made_take.h"

namespace mixrig::take {
namespace {

class DamagedMatroska : public ::testing::Test {
 protected:
  void SetUp() override {
    auto writer = TakeWriter::create(folder_ / "take", made_info(), StreamFormat::kMatroska);
    ASSERT_TRUE(writer);
    for (int number = 1; number <= 4; ++number) ASSERT_TRUE(writer->write(made_frame(number)));
    ASSERT_TRUE(writer->finish());
    whole_ = test::read_bytes(folder_ / "take/depth.mkv");
  }

  /// Reads every frame; true if all of them came.
  bool reads_all() {
    auto reader = TakeReader::open(folder_ / "take");
    if (!reader) return false;
    capture::Capture frame;
    for (int number = 1; number <= reader->info().frames; ++number)
      if (const auto read = reader->read(number, frame); !read) {
        EXPECT_NE(read.error().context.find("depth.mkv"), std::string::npos)
            << read.error().context;
        return false;
      }
    return true;
  }

  test::TemporaryFolder folder_;
  std::string whole_;
};

TEST_F(DamagedMatroska, CutFilesEndInAnErrorThatNamesTheFile) {
  EXPECT_TRUE(reads_all());
  for (const double part : {0.0, 0.1, 0.5, 0.8}) {
    folder_.write(
        "take/depth.mkv",
        whole_.substr(0, static_cast<std::size_t>(part * static_cast<double>(whole_.size()))));
    EXPECT_FALSE(reads_all()) << part;
  }
  folder_.write("take/depth.mkv", std::string(5000, 'x'));
  EXPECT_FALSE(reads_all());
  std::filesystem::remove(folder_ / "take/depth.mkv");
  EXPECT_EQ(TakeReader::open(folder_ / "take").error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace mixrig::take

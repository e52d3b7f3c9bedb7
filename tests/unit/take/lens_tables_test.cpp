// SPDX-License-Identifier: Apache-2.0
// Encoder values of a lens come back at mid-exposure, with the true view of each frame.
#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "host/capture/take/frame_tables.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/take/made_take.h"

namespace mixrig::take {
namespace {

TEST(LensTables, AreReadAtMidExposureOfEachFrame) {
  const test::TemporaryFolder folder;
  auto writer = TakeWriter::create(folder / "take", made_info(), StreamFormat::kPng);
  ASSERT_TRUE(writer) << writer.error().context;
  for (int number = 1; number <= 4; ++number) {
    capture::Capture frame = made_frame(number);
    frame.mid_exposure = HostTime(Duration(std::llround(frame.time_s * 1e9)));
    if (number != 3) frame.encoders = geometry::LensEncoders{1000.25 * number, -0.1};
    ASSERT_TRUE(writer->write(frame));
  }
  ASSERT_TRUE(writer->finish());
  auto reader = TakeReader::open(folder / "take");
  ASSERT_TRUE(reader) << reader.error().context;
  EXPECT_TRUE(reader->info().has_lens_values);
  capture::Capture frame;
  for (const int number : {1, 2, 4}) {
    ASSERT_TRUE(reader->read(number, frame));
    ASSERT_TRUE(frame.encoders) << number;
    EXPECT_NEAR(frame.encoders->zoom, 1000.25 * number, 0.1);  // times are rounded in poses.txt
  }
  // Without ticks.csv the frames' times are counted by the rate: samples are put on that clock.
  std::ofstream table(folder / "take/lens.csv");
  table << "time_ns,zoom,focus\n";
  for (int number = 1; number <= 4; ++number) {
    ASSERT_TRUE(reader->read(number, frame));
    const auto ns = frame.mid_exposure.time_since_epoch().count();
    table << ns - 10'000'000 << "," << 100 * number << ",1\n";
    table << ns + 10'000'000 << "," << 100 * number + 10 << ",3\n";
  }
  table.close();
  reader = TakeReader::open(folder / "take");
  ASSERT_TRUE(reader) << reader.error().context;
  for (int number = 1; number <= 4; ++number) {
    ASSERT_TRUE(reader->read(number, frame));
    ASSERT_TRUE(frame.encoders) << number;
    EXPECT_NEAR(frame.encoders->zoom, 100 * number + 5, 1e-6);
    EXPECT_NEAR(frame.encoders->focus, 2, 1e-6);
    EXPECT_FALSE(frame.lens);
  }
}

TEST(LensTables, RowsAreReadBackOrRefused) {
  const std::string rows = kLensHeader + lens_row({HostTime(Duration(-5)), {1.0 / 3, 1e7}}) +
                           lens_row({HostTime(Duration(6)), {-2, 0}});
  const auto samples = parse_lens_samples(rows, "lens.csv");
  ASSERT_TRUE(samples) << samples.error().context;
  ASSERT_EQ(samples->size(), 2U);
  EXPECT_EQ((*samples)[0].at, (geometry::LensEncoders{1.0 / 3, 1e7}));
  EXPECT_EQ((*samples)[1].time, HostTime(Duration(6)));
  for (const char* wrong : {"1,2\n", "1,2,3,4\n", "x,2,3\n", "1,nan,3\n", "1,2,inf\n", "1,2,\n",
                            "5,1,1\n5,1,1\n", "5,1,1\n4,1,1\n", "9223372036854775808,1,1\n"}) {
    const auto refused = parse_lens_samples(std::string(kLensHeader) + wrong, "lens.csv");
    ASSERT_FALSE(refused) << wrong;
    EXPECT_EQ(refused.error().context.rfind("lens.csv:", 0), 0U) << refused.error().context;
  }
}

TEST(LensTables, TrueViewsAreReadBackOrRefused) {
  const capture::TrueLens lens{{{64, 48}, 300.25, 301, 1.0 / 3, 24}, -0.0125};
  const auto read = parse_true_lens(kTrueLensHeader + true_lens_row(7, lens), "lens.csv", {64, 48});
  ASSERT_TRUE(read) << read.error().context;
  ASSERT_EQ(read->size(), 1U);
  EXPECT_EQ(read->at(7).view, lens.view);
  EXPECT_EQ(read->at(7).pupil_shift_m, lens.pupil_shift_m);
  for (const char* wrong : {"1,2,3,4,5\n", "1,0,3,4,5,0\n", "1,3,3,4,5,2\n", "1,3,3,nan,5,0\n",
                            "1,3,3,4,5,0\n1,3,3,4,5,0\n"})
    EXPECT_FALSE(parse_true_lens(std::string(kTrueLensHeader) + wrong, "lens.csv", {64, 48}))
        << wrong;
}

TEST(PeopleTable, PlacesAreReadBackOrRefused) {
  const std::vector<capture::TruePerson> two{{0, 3.25, -1.5, 1.75, 0.5}, {1, 4, 2, 1.25, 0}};
  const auto read = parse_people(kPeopleHeader + people_rows(7, two) + people_rows(9, {}), "p.csv");
  ASSERT_TRUE(read) << read.error().context;
  ASSERT_EQ(read->size(), 1U);
  EXPECT_EQ(read->at(7), two);
  for (const char* wrong : {"1,0,2,3,1\n", "1,-1,2,3,1,1\n", "1,0,nan,3,1,1\n", "1,0,2,3,1,-1\n",
                            "1,0,2,3,1,inf\n", "x,0,2,3,1,1\n"})
    EXPECT_FALSE(parse_people(std::string(kPeopleHeader) + wrong, "p.csv")) << wrong;
}

}  // namespace
}  // namespace mixrig::take

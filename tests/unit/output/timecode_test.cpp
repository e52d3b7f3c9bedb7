// SPDX-License-Identifier: Apache-2.0
#include "host/output/streams/timecode.h"

#include <cstdlib>
#include <ctime>

#include <gtest/gtest.h>

namespace mixrig::output {
namespace {

HostTime at_ms(double ms) { return HostTime(Duration(static_cast<std::int64_t>(1e6 * ms))); }

TEST(Timecode, CountsPicturesOfADay) {
  EXPECT_EQ(timecode_of(0, 25), (Timecode{0, 0, 0, 0}));
  EXPECT_EQ(timecode_of(24, 25), (Timecode{0, 0, 0, 24}));
  EXPECT_EQ(timecode_of(25, 25), (Timecode{0, 0, 1, 0}));
  EXPECT_EQ(timecode_of(25L * (3600 * 13 + 60 * 14 + 15) + 7, 25), (Timecode{13, 14, 15, 7}));
  EXPECT_EQ(timecode_of(25L * 86400 + 3, 25), (Timecode{0, 0, 0, 3})) << "the next day";
  EXPECT_EQ(timecode_of(-1, 60), (Timecode{23, 59, 59, 59}));
}

TEST(TimecodeCounter, LostPicturesLeaveAGapAndJitterDoesNotShow) {
  TimecodeCounter counter(25, nullptr);
  EXPECT_EQ(counter.next(at_ms(5013)), (Timecode{0, 0, 0, 0}));
  EXPECT_EQ(counter.next(at_ms(5013 + 40 + 15)), (Timecode{0, 0, 0, 1}));
  EXPECT_EQ(counter.next(at_ms(5013 + 80 - 15)), (Timecode{0, 0, 0, 2}));
  EXPECT_EQ(counter.next(at_ms(5013 + 40 * 30)), (Timecode{0, 0, 1, 5})) << "27 were lost";
}

TEST(TimecodeCounter, BeginsAtTheTimeOfDay) {
  const DayAtZero noon = [](HostTime) { return std::chrono::hours(12); };
  TimecodeCounter counter(25, noon);
  EXPECT_EQ(counter.next(at_ms(61'000 + 120)), (Timecode{12, 1, 1, 3}));
  EXPECT_EQ(counter.next(at_ms(61'000 + 160)), (Timecode{12, 1, 1, 4}));
  TimecodeCounter broadcast(30000.0 / 1001, noon);
  EXPECT_EQ(broadcast.per_second(), 30U);
  EXPECT_EQ(broadcast.next(at_ms(0)), (Timecode{12, 0, 0, 0}));
  EXPECT_EQ(broadcast.next(at_ms(1001)), (Timecode{12, 0, 1, 0})) << "no number is dropped";
}

/// NTP sets a board without a battery from 1970 to 2025 while it streams.
TEST(TimecodeCounter, FollowsASystemTimeThatIsSet) {
  ASSERT_EQ(setenv("TZ", "UTC0", 1), 0);
  tzset();
  std::int64_t epoch_ns = 0;
  TimecodeCounter counter(25, local_day_by([&] { return epoch_ns; }));
  EXPECT_EQ(counter.next(at_ms(1000)), (Timecode{0, 0, 1, 0}));
  epoch_ns = 1'750'000'000'000'000'000;  // 15:06:40
  EXPECT_EQ(counter.next(at_ms(1040)), (Timecode{0, 0, 1, 1})) << "it is read every second";
  EXPECT_EQ(counter.next(at_ms(2000)), (Timecode{15, 6, 42, 0}));
  epoch_ns += 49'000'000;
  EXPECT_EQ(counter.next(at_ms(3000)), (Timecode{15, 6, 43, 0})) << "the error of a reading";
  epoch_ns -= 3'600'000'000'000;
  EXPECT_EQ(counter.next(at_ms(4000)), (Timecode{14, 6, 44, 1}));
}

TEST(LocalDay, FollowsTheTimeZone) {
  ASSERT_EQ(setenv("TZ", "EST5", 1), 0);
  tzset();
  EXPECT_EQ(local_day_at_zero(0, HostTime()), std::chrono::hours(19));
  ASSERT_EQ(setenv("TZ", "UTC0", 1), 0);
  tzset();
  EXPECT_EQ(local_day_at_zero(86'400'000'000'000 + 1, HostTime(std::chrono::hours(5))),
            Duration(1));
}

}  // namespace
}  // namespace mixrig::output

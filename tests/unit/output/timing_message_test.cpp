// SPDX-License-Identifier: Apache-2.0
// Messages of H.264 against units that were put together by hand from the standard (7.3.2.3, D.1).
#include "host/output/streams/timing_message.h"

#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace mixrig::output {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes joined(std::initializer_list<Bytes> parts) {
  Bytes all;
  for (const Bytes& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

const Bytes kDelimiter{0, 0, 0, 1, 9, 0xF0};
const Bytes kStart{0, 0, 0, 1, 6}, kShortStart{0, 0, 1, 6};
const Bytes kTiming{1, 3, 0x12, 0x34, 0x56};
const Bytes kUser{5, 4, 1, 2, 3, 0x80};
const Bytes kSlice{0, 0, 1, 0x65, 0x88, 0x80, 0, 0, 3, 1, 6, 0x80, 0x80};

Bytes mended(Bytes unit) {
  unit.resize(end_messages(unit));
  return unit;
}

TEST(TimingMessage, LosesWhatFollowsItsEnd) {
  const Bytes good = joined({kDelimiter, kStart, kTiming, {0x80}, kSlice});
  for (const Bytes& extra : {Bytes{0x80}, Bytes{0x04, 0x80}, Bytes{0x04, 0x80, 0x80}, Bytes{0xFF}})
    EXPECT_EQ(mended(joined({kDelimiter, kStart, kTiming, {0x80}, extra, kSlice})), good);
  EXPECT_EQ(mended(joined({kStart, kTiming, {0x80, 0x80}})), joined({kStart, kTiming, {0x80}}));
}

TEST(TimingMessage, WhatIsRightStays) {
  const Bytes escaped{1, 4, 0, 0, 3, 1, 0x80};  // 00 00 01 80, with an escape
  for (const Bytes& unit :
       {joined({kDelimiter, kStart, kTiming, {0x80}, kSlice}),
        joined({kStart, kTiming, kUser, {0x80}, kShortStart, kTiming, {0x80}, kSlice}),
        joined({kStart, escaped, {0x80}, kSlice}), joined({kSlice, kStart, kTiming, {0x80, 0x80}}),
        Bytes{}, Bytes{0, 0, 1}})
    EXPECT_EQ(mended(unit), unit);
}

TEST(TimingMessage, MessagesWithoutAnEndAreLeftOut) {
  const Bytes good = joined({kDelimiter, kStart, kTiming, {0x80}, kSlice});
  const Bytes text{5, 4, 1, 2, 3, 0};  // x264's text ends by a zero
  for (const Bytes& cut : {text, kTiming, Bytes{1, 9, 1, 2}, Bytes{0xFF, 0xFF}, Bytes{}})
    EXPECT_EQ(mended(joined({kDelimiter, kShortStart, cut, Bytes(good.begin() + 6, good.end())})),
              good);
}

TEST(TimingMessage, SeveralUnitsAreMendedAndTheEscapesCount) {
  const Bytes escaped{1, 5, 0, 0, 3, 0, 0, 3, 2};  // 00 00 00 00 02
  EXPECT_EQ(
      mended(joined({kStart, escaped, {0x80, 0x80}, kStart, kUser, {0x80, 0x04, 0x80}, kSlice})),
      joined({kStart, escaped, {0x80}, kStart, kUser, {0x80}, kSlice}));
}

TEST(TimingMessage, AnyBytesEndAndNoneAreAdded) {
  std::mt19937 random(7);
  for (int i = 0; i < 20000; ++i) {
    Bytes unit(random() % 64);
    for (std::uint8_t& byte : unit) byte = static_cast<std::uint8_t>(random() % 8 * (random() % 9));
    const std::size_t size = end_messages(unit);
    ASSERT_LE(size, unit.size());
    unit.resize(size);
    EXPECT_EQ(end_messages(unit), size) << "nothing is left to mend";
  }
}

}  // namespace
}  // namespace mixrig::output

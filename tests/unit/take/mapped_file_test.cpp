// SPDX-License-Identifier: Apache-2.0
// Files that get shorter while they are read.
#include "host/capture/take/foreign/mapped_file.h"

#include <algorithm>
#include <csignal>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::take {
namespace {

constexpr std::size_t kSize = 1 << 20, kLeft = 100'000;

TEST(MappedFile, WhatIsCutOffMeanwhileReadsAsZerosAndIsAnError) {
  const test::TemporaryFolder folder;
  const auto path = folder.write("a.bag", std::string(kSize, 'x'));
  auto file = MappedFile::open(path);
  auto other = MappedFile::open(folder.write("b.bag", std::string(kSize, 'y')));
  ASSERT_TRUE(file && other);
  EXPECT_TRUE(file->if_whole({}));
  std::filesystem::resize_file(path, kLeft);
  const auto bytes = file->bytes();
  EXPECT_EQ(std::count(bytes.begin(), bytes.begin() + kLeft, 'x'), kLeft);
  EXPECT_EQ(std::accumulate(bytes.begin() + kLeft, bytes.end(), std::size_t{0}), 0U);
  EXPECT_TRUE(test::refused(file->if_whole({}), {"got shorter while it was read"}, ErrorCode::kIo));
  EXPECT_TRUE(other->if_whole({})) << "of another file";
}

TEST(MappedFile, AFreedPlaceIsTakenAgain) {
  const test::TemporaryFolder folder;
  const auto path = folder.write("a.bag", "bytes");
  for (int i = 0; i < 3; ++i) {
    std::vector<MappedFile> files;
    for (int k = 0; k < 8; ++k) {
      auto file = MappedFile::open(path);
      ASSERT_TRUE(file) << file.error().context;
      files.push_back(std::move(*file));
    }
    EXPECT_TRUE(test::refused(MappedFile::open(path), {"eight recordings"}));
  }
}

TEST(MappedFileDeathTest, AnotherBusErrorEndsTheProcessAsBefore) {
  const test::TemporaryFolder folder;
  auto file = MappedFile::open(folder.write("a.bag", "bytes"));
  ASSERT_TRUE(file);
  EXPECT_EXIT(std::raise(SIGBUS), testing::KilledBySignal(SIGBUS), "");
}

}  // namespace
}  // namespace mixrig::take

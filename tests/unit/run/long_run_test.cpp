// SPDX-License-Identifier: Apache-2.0
// Memory does not grow with the number of frames.
#include <gtest/gtest.h>

#include "host/run/loop/run.h"
#include "tests/support/box_source.h"
#include "tests/support/resident_memory.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::session {
namespace {

TEST(LongRun, ResidentMemoryStaysWhereItWasAfterAThousandFrames) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer keeps what was freed, and notes of what was written";
#endif
  constexpr int kFrames = 6000, kFirst = 1000, kLast = 5900;
  const test::TemporaryFolder folder;
  Session session;
  session.source = std::make_unique<test::BoxSource>(5, kFrames);
  session.scene.background.learn = {1, 5};
  session.setup = *setup_of(session.source->info(), std::nullopt);
  session.backend = {render::Backend::kCpu, 1};
  RunOptions options;
  options.out = folder / "out";
  options.output.format = output::OutputFormat::kNone;
  options.judge = false;
  options.sheet_rows = 1;  // of 1.4 MB
  const SystemClock clock;
  double early_mb = 0, late_mb = 0;
  const auto report = run(session, options, clock, [&](std::string_view what, int done, int) {
    if (what == "frames" && done == kFirst) early_mb = test::resident_mb();
    if (what == "frames" && done == kLast) late_mb = test::resident_mb();
  });
  ASSERT_TRUE(report) << report.error().context;
  EXPECT_EQ(report->frames.frame_ms.count(), static_cast<std::uint64_t>(kFrames - 5));
  EXPECT_GT(early_mb, 1.0);
  EXPECT_LT(late_mb - early_mb, 3.0);
}

}  // namespace
}  // namespace mixrig::session

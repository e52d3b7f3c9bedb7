// SPDX-License-Identifier: Apache-2.0
// Resident memory of a long run: a small source composited for many frames, with files and sheet.
// usage: long_run_bench FRAMES OUT
#include <cstdio>
#include <cstdlib>

#include "host/run/loop/run.h"
#include "tests/support/box_source.h"
#include "tests/support/resident_memory.h"

int main(int argc, char** argv) {
  using namespace mixrig;
  if (argc != 3) {
    std::fputs("usage: long_run_bench FRAMES OUT\n", stderr);
    return 2;
  }
  const int frames = std::atoi(argv[1]);
  session::Session session;
  session.source = std::make_unique<test::BoxSource>(5, frames);
  session.scene.background.learn = {1, 5};
  session.setup = *session::setup_of(session.source->info(), std::nullopt);
  session.backend = {render::Backend::kCpu, 1};
  session::RunOptions options;
  options.out = argv[2];
  options.output.format = output::OutputFormat::kNone;
  const SystemClock clock;
  double at_1000_mb = 0;
  const auto report =
      session::run(session, options, clock, [&](std::string_view what, int done, int) {
        if (what == "frames" && done == 1000) at_1000_mb = test::resident_mb();
      });
  if (!report) return std::fprintf(stderr, "%s\n", report.error().context.c_str()), 1;
  const double end_mb = test::resident_mb();
  std::printf(
      "%llu frames, %.3f ms a frame; resident %.2f MB after 1000 frames, %.2f MB at the end: %+.2f "
      "MB\n",
      static_cast<unsigned long long>(report->frames.frame_ms.count()),
      report->frames.frame_ms.mean(), at_1000_mb, end_mb, end_mb - at_1000_mb);
  return 0;
}

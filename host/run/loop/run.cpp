// SPDX-License-Identifier: Apache-2.0
#include "host/run/loop/run.h"

#include <utility>

#include <fmt/format.h>

#include "hal/base/guarded.h"
#include "host/run/loop/runner.h"

namespace mixrig::session {
namespace {

Result<FrameRange> range_of(const Session& session, const RunOptions& options) {
  const FrameRange range = options.frames.value_or(session.default_frames());
  const int frames = session.source->info().frames;
  if (!options.frames && range.first > range.second)
    return Error{ErrorCode::kUsage,
                 fmt::format("the take has frames 1-{} and the background is learned from all of "
                             "them: none is left to composite, select some by --frames",
                             frames)};
  if (range.first < 1 || range.second < range.first || range.second > frames)
    return Error{ErrorCode::kUsage,
                 fmt::format("--frames {}-{} is out of range: the take has frames 1-{}",
                             range.first, range.second, frames)};
  return range;
}

/// Composites `range` until it ends, the source ends or `stop` is set.
Result<RunReport> run_frames(Runner& runner, FrameRange range, const ProgressFn& progress,
                             const std::atomic<bool>* stop) {
  MIXRIG_TRY(runner.prepare(range, progress));
  const auto stopped = [&] { return stop != nullptr && *stop; };
  for (int number = range.first; !stopped(); ++number) {
    MIXRIG_ASSIGN(const bool there, runner.frame());
    if (!there && !stopped()) return runner.finish(runner.ended());
    if (!there) break;
    if (progress && range.second != capture::kEndless)
      progress("frames", number - range.first + 1, range.second - range.first + 1);
    if (number == range.second) return runner.finish("frames");
  }
  return runner.finish("stopped");
}

}  // namespace

Result<RunReport> run(Session& session, const RunOptions& options, const Clock& clock,
                      const ProgressFn& progress, RunParts parts) {
  MIXRIG_ASSIGN(const FrameRange range, range_of(session, options));
  const std::atomic<bool>* stop = parts.stop;
  Runner runner(session, options, clock, std::move(parts));
  std::optional<RunReport> report;
  const Result<void> done = guarded("compositing", [&]() -> Result<void> {
    MIXRIG_ASSIGN(report, run_frames(runner, range, progress, stop));
    return {};
  });
  if (!done) return runner.keep(done.error());
  return *std::move(report);
}

}  // namespace mixrig::session

// SPDX-License-Identifier: Apache-2.0
#include "host/capture/live/session/record.h"

#include "hal/base/guarded.h"
#include "host/capture/live/session/lens_stream.h"
#include "host/capture/live/session/live_capture.h"
#include "host/capture/live/session/take_row.h"

namespace mixrig::live {

namespace {

constexpr Duration kRecordWait = std::chrono::milliseconds(200);
constexpr Duration kFirstFrameTimeout = std::chrono::seconds(5);  // until the first frame

/// Records sets until a condition ends the recording; returns the reason.
Result<std::string> record_sets(LiveSession& session, TakeRow& row, const RecordOptions& options,
                                const std::atomic<bool>& stop, Clock& clock,
                                std::uint64_t& left_out) {
  const HostTime begin = clock.now();
  const bool is_endless = options.duration == Duration::zero();
  HostTime end = begin + kFirstFrameTimeout;  // the time counts from the first frame on
  while (clock.now() < end) {
    if (stop) return std::string("stopped");
    MIXRIG_ASSIGN(std::string full, row.ends_by_space());
    if (!full.empty()) return full;
    const bool over = session.ended();
    const auto set = session.next(over ? Duration(0) : kRecordWait);
    if (!set && over) MIXRIG_TRY(session.fault());
    if (!set && over) return std::string("end of the cameras");
    if (!set) continue;
    const bool first = row.frames() == 0;
    MIXRIG_ASSIGN(const bool written, row.write(*set));
    if (!written) ++left_out;
    if (first && written) end = is_endless ? HostTime::max() : clock.now() + options.duration;
    if (!first && options.progress)
      options.progress(is_endless ? 0 : 1 - seconds(end - clock.now()) / seconds(options.duration));
  }
  return std::string(row.frames() > 0 ? "duration" : "no frames");
}

}  // namespace

Result<RecordReport> record(LiveSession& session, const RigConfig& config, const Devices& devices,
                            const RecordOptions& options, const std::atomic<bool>& stop,
                            Clock& clock) {
  MIXRIG_ASSIGN(const take::TakeInfo info, take_info(config, devices));
  MIXRIG_ASSIGN(auto lens, LensStream::open(config, devices, clock));
  TakeRow row(config, devices, options, info, lens.get());
  MIXRIG_TRY(row.open());
  MIXRIG_TRY(session.start());
  RecordReport report;
  Result<void> recorded = guarded("recording", [&]() -> Result<void> {
    MIXRIG_ASSIGN(report.ended, record_sets(session, row, options, stop, clock, report.left_out));
    return {};
  });
  session.stop();
  report.session = session.report();
  report.frames = row.frames();
  if (report.frames == 0)
    return Error{ErrorCode::kDevice,
                 "no frames came from the cameras that could be paired: run mixrig diag"};
  // Frames written before an error are kept as a complete, shorter take.
  const Result<void> finished = row.finish();
  report.takes = row.takes(), report.deleted = row.deleted();
  if (!finished && recorded) recorded = finished.error();
  if (!recorded) {
    Error error = std::move(recorded).error();
    error.context += ": the take ends after " + std::to_string(report.frames) + " frames";
    return error;
  }
  return report;
}

}  // namespace mixrig::live

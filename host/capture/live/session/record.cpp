// SPDX-License-Identifier: Apache-2.0
#include "host/capture/live/session/record.h"

#include "hal/base/guarded.h"
#include "host/capture/live/session/lens_stream.h"
#include "host/capture/live/session/live_capture.h"
#include "host/capture/live/session/segment_recorder.h"

namespace mixrig::live {

namespace {

constexpr Duration kRecordWait = std::chrono::milliseconds(200);
constexpr Duration kFirstFrameTimeout = std::chrono::seconds(5);  // until the first frame

/// Records sets until a condition ends the recording; returns the reason.
Result<std::string> record_sets(LiveSession& session, SegmentRecorder& recorder,
                                const RecordOptions& options, const std::atomic<bool>& stop,
                                Clock& clock, std::uint64_t& left_out) {
  const HostTime begin = clock.now();
  const bool is_endless = options.duration == Duration::zero();
  HostTime end = begin + kFirstFrameTimeout;  // the time counts from the first frame on
  while (clock.now() < end) {
    if (stop) return std::string("stopped");
    MIXRIG_ASSIGN(std::string full, recorder.ends_by_space());
    if (!full.empty()) return full;
    const bool over = session.ended();
    const auto set = session.next(over ? Duration(0) : kRecordWait);
    if (!set && over) MIXRIG_TRY(session.fault());
    if (!set && over) return std::string("end of the cameras");
    if (!set) continue;
    const bool first = recorder.frames() == 0;
    MIXRIG_ASSIGN(const bool written, recorder.write(*set));
    if (!written) ++left_out;
    if (first && written) end = is_endless ? HostTime::max() : clock.now() + options.duration;
    if (!first && options.progress)
      options.progress(is_endless ? 0 : 1 - seconds(end - clock.now()) / seconds(options.duration));
  }
  return std::string(recorder.frames() > 0 ? "duration" : "no frames");
}

}  // namespace

Result<RecordReport> record(LiveSession& session, const RigConfig& config, const Devices& devices,
                            const RecordOptions& options, const std::atomic<bool>& stop,
                            Clock& clock) {
  MIXRIG_ASSIGN(const take::TakeInfo info, take_info(config, devices));
  MIXRIG_ASSIGN(auto lens, LensStream::open(config, devices, clock));
  SegmentRecorder recorder(config, devices, options, info, lens.get());
  MIXRIG_TRY(recorder.open());
  MIXRIG_TRY(session.start());
  RecordReport report;
  Result<void> recorded = guarded("recording", [&]() -> Result<void> {
    MIXRIG_ASSIGN(report.ended,
                  record_sets(session, recorder, options, stop, clock, report.left_out));
    return {};
  });
  session.stop();
  report.session = session.report();
  report.frames = recorder.frames();
  if (report.frames == 0)
    return Error{ErrorCode::kDevice,
                 "no frames came from the cameras that could be paired: run mixrig diag"};
  // Frames written before an error are kept as a complete, shorter take.
  const Result<void> finished = recorder.finish();
  report.takes = recorder.takes(), report.deleted = recorder.deleted();
  if (!finished && recorded) recorded = finished.error();
  if (!recorded) {
    Error error = std::move(recorded).error();
    error.context += ": the take ends after " + std::to_string(report.frames) + " frames";
    return error;
  }
  return report;
}

}  // namespace mixrig::live

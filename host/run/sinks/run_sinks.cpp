// SPDX-License-Identifier: Apache-2.0
#include "host/run/sinks/run_sinks.h"

#include <utility>

#include "hal/base/clock_sync.h"
#include "hal/base/log.h"
#include "host/output/sheet/sheet_sink.h"
#include "host/output/streams/timecode.h"

namespace mixrig::session {
namespace {

constexpr int kSheetStep = 10;  // row k of an endless sheet: frame first + 10 k^2

/// Frames of the sheet: spread over the range, or at growing distances where it has no end.
std::vector<int> sheet_frames(FrameRange range, int rows) {
  if (range.second != capture::kEndless) return output::spread(range.first, range.second, rows);
  std::vector<int> frames;
  for (int k = 0; k < rows; ++k) frames.push_back(range.first + kSheetStep * k * k);
  return frames;
}

}  // namespace

double RunSinks::rate_hz() const {
  const double rate_hz = session_.source->info().rate_hz;
  return rate_hz > 0 ? rate_hz : 25;
}

/// Whether composites have transparent parts: where a set has no picture.
bool RunSinks::is_transparent() const {
  return session_.setup.backdrop && session_.setup.backdrop->picture.empty();
}

output::SinkThread* RunSinks::add(std::unique_ptr<output::CompositeSink> sink) {
  const auto when_full = live() ? output::WhenFull::kDropOldest : output::WhenFull::kWait;
  sinks_.push_back(std::make_unique<output::SinkThread>(std::move(sink), when_full, gate_));
  return sinks_.back().get();
}

Result<void> RunSinks::open(FrameRange range, const std::optional<std::filesystem::path>& folder,
                            std::vector<std::unique_ptr<output::CompositeSink>> sinks,
                            const RunExtras& extras) {
  if (folder) MIXRIG_TRY(open_files(range, *folder));
  for (auto& sink : sinks) add(std::move(sink));
  MIXRIG_TRY(check_streams());
  return open_extras(folder, extras);
}

Result<void> RunSinks::open_files(FrameRange range, const std::filesystem::path& folder) {
  const capture::SourceInfo& info = session_.source->info();
  output::OutputOptions output = options_.output;
  output.alpha = is_transparent();
  MIXRIG_ASSIGN(auto files, output::FilesSink::create(folder, info, session_.setup.view, output));
  files_ = add(std::move(files));
  sheet_ = add(std::make_unique<output::SheetSink>(
      folder / "contact_sheet.png", session_.scene.path.filename().string() + " in " + info.name,
      sheet_frames(range, options_.sheet_rows)));
  return {};
}

Result<void> RunSinks::check_streams() {
  streams_ = session_.scene.stream_outs;
  streams_.insert(streams_.end(), options_.streams.begin(), options_.streams.end());
  for (const scene::StreamOut& out : streams_)
    MIXRIG_TRY(output::StreamSink::check(out, session_.setup.view.size_px, rate_hz()));
  return {};
}

Result<void> RunSinks::open_streams() {
  const render::CompositorSetup& setup = session_.setup;
  output::DayAtZero day;  // of live pictures; a recording counts from its beginning
  if (live() && options_.epoch) day = output::local_day_by(options_.epoch);
  if (day && !streams_.empty() && !host_clock_is_synchronized())
    log_warning("session",
                "the time is not known: no NTP or PTP sets this machine's clock: time code follows "
                "it, and jumps when it is set");
  for (const scene::StreamOut& out : streams_) {
    output::RoomBehind behind;
    if (out.picture == scene::StreamOut::Picture::kStereo && !setup.backdrop)
      behind = output::room_behind(setup.background);
    MIXRIG_ASSIGN(auto sink, output::StreamSink::create(out, setup.view.size_px, rate_hz(),
                                                        is_transparent(), std::move(behind), day));
    stream_sinks_.push_back(sink.get());
    add(std::move(sink));
  }
  return {};
}

Result<void> RunSinks::open_extras(const std::optional<std::filesystem::path>& folder,
                                   const RunExtras& extras) {
  for (const auto& extra : extras) {
    MIXRIG_ASSIGN(auto sinks, extra->open({session_, clock_, folder, options_.epoch}));
    ObjectMover* const mover = extra->mover();
    if (mover != nullptr) mover_ = mover;
    for (auto& sink : sinks) {
      output::SinkThread* const thread = add(std::move(sink));
      if (mover != nullptr) before_moves_.push_back(thread);
    }
  }
  return {};
}

void RunSinks::wait_for_mover() {
  for (output::SinkThread* sink : before_moves_) sink->wait_until_idle();
}

/// Images that a sink wants of a frame; the files want none while the operator does not record.
render::OutputMask RunSinks::wanted_by(const output::SinkThread& sink, int number) const {
  return !recording_ && &sink == files_ ? 0 : sink.sink().wanted(number);
}

/// Images that the sinks want of a frame. In a recording those of the sheet are not kept, since
/// deliver() waits for it.
RunSinks::Wanted RunSinks::wanted(int number) const {
  Wanted images;
  for (const auto& sink : sinks_) {
    const render::OutputMask mask = wanted_by(*sink, number);
    images.all |= mask;
    if (live() || sink.get() != sheet_) images.kept |= mask;
  }
  return images;
}

bool RunSinks::on_sheet(int number) const {
  return sheet_ != nullptr && sheet_->sink().wanted(number) != 0;
}

Result<void> RunSinks::deliver(const output::CompositePtr& composite) {
  for (const auto& sink : sinks_) {
    if (wanted_by(*sink, composite->capture->number) == 0) continue;
    MIXRIG_TRY(sink->push(composite));
    // Composites with inspection images are large: of a recording only one exists at a time.
    if (!live() && sink.get() == sheet_) sink->wait_until_idle();
    sheet_has_rows_ |= sink.get() == sheet_;
  }
  return {};
}

Result<void> RunSinks::finish() {
  Result<void> done;
  for (const auto& sink : sinks_) {
    const Result<void> ended = sink->finish();
    if (done && !ended) done = ended.error();
  }
  return done;
}

std::vector<output::SinkReport> RunSinks::reports() const {
  std::vector<output::SinkReport> reports;
  for (const auto& sink : sinks_) reports.push_back(sink->report());
  return reports;
}

std::vector<output::StreamOutReport> RunSinks::stream_reports() const {
  std::vector<output::StreamOutReport> reports;
  for (const output::StreamSink* sink : stream_sinks_) reports.push_back(sink->report());
  return reports;
}

}  // namespace mixrig::session

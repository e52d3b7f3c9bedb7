// SPDX-License-Identifier: Apache-2.0
#include "host/capture/live/session/segment_recorder.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "hal/base/guarded.h"
#include "hal/base/log.h"
#include "host/capture/take/segments/segments.h"

namespace mixrig::live {
namespace fs = std::filesystem;

namespace {

// Frames between checks of the free disk space, and between counts of what the take holds.
constexpr int kFramesPerDiskCheck = 10, kFramesPerCount = 100;
constexpr double kBytesInMegabyte = 1048576.0;

std::uint64_t free_bytes_at(const fs::path& folder) {
  std::error_code error;
  const auto space = fs::space(folder, error);
  return error ? 0 : space.available;
}

std::vector<take::Segment> whole_segments(const fs::path& folder) {
  std::vector<take::Segment> segments = take::segments_of(folder);
  std::erase_if(segments, [](const take::Segment& segment) { return segment.is_partial; });
  return segments;
}

std::uint64_t bytes_of(const std::vector<take::Segment>& segments) {
  std::uint64_t bytes = 0;
  for (const take::Segment& segment : segments) bytes += take::bytes_below(segment.path);
  return bytes;
}

}  // namespace

SegmentRecorder::SegmentRecorder(const RigConfig& config, const Devices& devices,
                                 const RecordOptions& options, take::TakeInfo info,
                                 LensStream* lens)
    : config_(config),
      devices_(devices),
      options_(options),
      segments_(options.segments),
      info_(std::move(info)),
      lens_(lens) {}

SegmentRecorder::~SegmentRecorder() {
  if (closing_.joinable()) closing_.join();
}

std::uint64_t SegmentRecorder::free_bytes() const {
  if (options_.free_bytes) return options_.free_bytes(options_.out);
  if (segments_.any()) return free_bytes_at(options_.out);  // it may be a disk of its own
  return free_bytes_at(options_.out.has_parent_path() ? options_.out.parent_path() : ".");
}

bool SegmentRecorder::is_over_share(std::uint64_t further_bytes) const {
  return segments_.most_bytes > 0 && whole_bytes_ + further_bytes > segments_.most_bytes;
}

/// Deletes the oldest whole segments, but not the last one, until `wanted_bytes` fit into the share
/// and onto the disk.
void SegmentRecorder::make_space(std::uint64_t wanted_bytes) {
  std::vector<take::Segment> whole = whole_segments(options_.out);
  whole_bytes_ = bytes_of(whole);
  if (!segments_.drop_oldest) return;
  const auto is_short = [&] {
    return is_over_share(wanted_bytes) || free_bytes() < options_.least_free_bytes + wanted_bytes;
  };
  while (whole.size() > 1 && is_short()) {
    std::error_code error;
    fs::remove_all(whole.front().path, error);
    if (error)
      return log_warning("record",
                         "cannot delete '" + whole.front().path.string() + "': " + error.message());
    log_info("record", "deleted the oldest take, '" + whole.front().path.string() + "'");
    ++deleted_;
    whole.erase(whole.begin());
    whole_bytes_ = bytes_of(whole);
  }
}

Result<std::unique_ptr<TakeRecorder>> SegmentRecorder::next_recorder() {
  fs::path out = options_.out;
  if (segments_.any()) {
    MIXRIG_ASSIGN(out, take::next_segment(options_.out));
  }
  MIXRIG_ASSIGN(auto writer, take::TakeWriter::create(out, info_, options_.format));
  auto recorder = std::make_unique<TakeRecorder>(config_, devices_, std::move(writer), lens_);
  MIXRIG_TRY(recorder->begin());
  ++takes_;
  return recorder;
}

Result<void> SegmentRecorder::open() {
  if (segments_.any()) {
    MIXRIG_TRY(take::next_segment(options_.out));
    make_space(0);
  }
  const auto megabytes = [](std::uint64_t bytes) {
    return static_cast<double>(bytes) / kBytesInMegabyte;
  };
  if (is_over_share(0))
    return Error{ErrorCode::kIo,
                 fmt::format("'{}' holds {:.0f} MB, and may hold {:.0f} MB: delete takes, or add "
                             "--drop-oldest",
                             options_.out.string(), megabytes(whole_bytes_),
                             megabytes(segments_.most_bytes))};
  if (const std::uint64_t free = free_bytes(); free < options_.least_free_bytes)
    return Error{
        ErrorCode::kIo,
        fmt::format("'{}': the disk is almost full, {:.0f} MB are free and {:.0f} MB are "
                    "to be kept: free some, record elsewhere, or lower --keep-free",
                    options_.out.string(), megabytes(free), megabytes(options_.least_free_bytes))};
  MIXRIG_ASSIGN(recorder_, next_recorder());
  return {};
}

/// Waits for the take before. Errors: its own.
Result<void> SegmentRecorder::join() {
  if (closing_.joinable()) closing_.join();
  closes_ = false;
  if (!error_) return {};
  return *std::exchange(error_, std::nullopt);
}

/// Goes on in the next segment; a thread completes the one that was written.
Result<void> SegmentRecorder::turn() {
  MIXRIG_TRY(join());
  MIXRIG_ASSIGN(auto next, next_recorder());
  std::shared_ptr<TakeRecorder> done = std::exchange(recorder_, std::move(next));
  earlier_ += done->frames();
  is_full_ = false;
  closes_ = true;
  closing_ = guarded_thread(
      "end of a segment",
      [this, done]() -> Result<void> {
        const std::uint64_t bytes = take::bytes_below(done->folder());
        MIXRIG_TRY(done->finish());
        make_space(bytes);
        closes_ = false;
        return {};
      },
      [this](const Error& error) {
        error_ = error;
        failed_ = true, closes_ = false;
      });
  return {};
}

Result<bool> SegmentRecorder::write(const LiveSet& set) {
  if (failed_) MIXRIG_TRY(join());
  const Duration length = set.frames.frames[0].mid_exposure - recorder_->first();
  const bool is_long = segments_.length > Duration::zero() && length >= segments_.length;
  if (recorder_->frames() > 0 && (is_full_ || is_long)) MIXRIG_TRY(turn());
  return recorder_->write(set);
}

Result<std::string> SegmentRecorder::ends_by_space() {
  const int number = recorder_->frames();
  if (number == 0 || number % kFramesPerDiskCheck != 0) return std::string();
  const bool is_scarce = free_bytes() < options_.least_free_bytes;
  bool is_over = false;
  const bool counts = segments_.bytes > 0 || segments_.most_bytes > 0;
  if (counts && number % kFramesPerCount == 0) {
    const std::uint64_t bytes = take::bytes_below(recorder_->folder());
    is_full_ = segments_.bytes > 0 && bytes >= segments_.bytes;
    is_over = is_over_share(bytes);
  }
  if (!is_scarce && !is_over) return std::string();
  if (closes_) return std::string();  // its thread makes space
  if (segments_.drop_oldest && !whole_segments(options_.out).empty()) {
    MIXRIG_TRY(turn());
    return std::string();
  }
  return std::string(is_scarce ? "disk almost full" : "the folder has its share of the disk");
}

Result<void> SegmentRecorder::finish() {
  const Result<void> before = join();
  if (recorder_->frames() == 0 && earlier_ > 0) return before;
  const Result<void> done = recorder_->finish();
  return before ? done : before;
}

}  // namespace mixrig::live

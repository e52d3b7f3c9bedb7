// SPDX-License-Identifier: Apache-2.0
#include "host/capture/live/session/record.h"

#include <cstdio>
#include <iterator>
#include <memory>

#include <fcntl.h>
#include <fmt/format.h>

#include "hal/base/guarded.h"
#include "host/capture/live/session/lens_stream.h"
#include "host/capture/live/session/live_capture.h"
#include "host/math/image_io/image_io.h"

namespace mixrig::live {
namespace fs = std::filesystem;

namespace {

constexpr Duration kRecordWait = std::chrono::milliseconds(200);
constexpr Duration kFirstFrameTimeout = std::chrono::seconds(5);  // until the first frame
// Frames between checks of the free disk space.
constexpr int kFramesPerDiskCheck = 10;
constexpr const char *kTicks = "ticks.csv", *kHead = "pan_tilt.csv";
constexpr const char* kTicksColumns = "frame,stream,tick,counter,mid_exposure_ns,residual_us\n";
constexpr const char* kHeadColumns = "frame,pan_rad,tilt_rad\n";
// Space for index and manifest of a take.
constexpr long kReserve_bytes = 4L << 20;

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

std::uint64_t free_bytes_at(const fs::path& path) {
  std::error_code error;
  const auto folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const auto space = fs::space(folder, error);
  return error ? 0 : space.available;
}

/// Writes sets; one object per recording.
class Recorder {
 public:
  Recorder(const RigConfig& config, const Devices& devices, take::TakeWriter writer,
           std::unique_ptr<LensStream> lens)
      : config_(config),
        devices_(devices),
        lens_(std::move(lens)),
        decoder_(config, devices),
        writer_(std::move(writer)),
        extra_(config.cameras.size()) {
    for (std::size_t i = 0; i < extra_.size(); ++i)
      extra_[i].decoder =
          capture::ColorDecoder(color_settings(config.cameras[i], devices.cameras[i]->info()));
  }

  /// Reserves disk space that finish() frees: a take on a full disk can still be finished.
  Result<void> reserve() {
    reserve_ = writer_.staging() / "reserve";
    const File file(std::fopen(reserve_.c_str(), "w"));
    const int failed = file ? ::posix_fallocate(::fileno(file.get()), 0, kReserve_bytes) : 0;
    if (file && failed == 0) return {};
    return system_error(ErrorCode::kIo,
                        "cannot reserve space for a take in '" + writer_.staging().string() +
                            "': free some, or record elsewhere",
                        file ? failed : errno);
  }

  Result<void> open_tables() {
    MIXRIG_TRY(writer_.append(kTicks, kTicksColumns, {}));
    return writer_.append(kHead, kHeadColumns, {});
  }

  /// Writes a set; false for one without readable colour and depth.
  Result<bool> write(const LiveSet& set) {
    if (!decoder_.decode(set, frame_)) return false;
    const HostTime at = set.frames.frames[0].mid_exposure;
    if (number_ == 0) first_ = at;
    frame_.number = number_ + 1;
    frame_.time_s = seconds(at - first_);
    frame_.encoders = lens_ ? lens_->at(at) : std::nullopt;
    MIXRIG_TRY(writer_.write(frame_));
    ++number_;
    MIXRIG_TRY(write_rows(set));
    MIXRIG_TRY(write_others(set));
    return true;
  }

  Result<void> finish() {
    std::error_code ignored;  // a remaining file does no harm
    std::filesystem::remove(reserve_, ignored);
    return writer_.finish();
  }
  const fs::path& folder() const { return writer_.staging(); }
  int frames() const { return number_; }

 private:
  /// Writes the frames of the other cameras, each once, except the fisheye, which is in the take.
  Result<void> write_others(const LiveSet& set) {
    for (std::size_t i = 1; i < devices_.cameras.size(); ++i) {
      if (i == fisheye_index(config_)) continue;
      const auto& timed = set.frames.frames[i];
      Extra& extra = extra_[i];
      if (!timed.frame || (extra.count > 0 && timed.frame->sequence == extra.last)) continue;
      if (!extra.decoder.decode(*timed.frame, extra.picture)) continue;
      const fs::path folder = writer_.staging() / config_.cameras[i].name;
      std::error_code ignored;  // write_png reports a missing folder
      if (extra.count == 0) fs::create_directories(folder, ignored);
      char name[32];
      std::snprintf(name, sizeof name, "%06d.png", ++extra.count);
      extra.last = timed.frame->sequence;
      MIXRIG_TRY(image_io::write_png(folder / name, extra.picture.view()));
      writer_.wrote(folder / name);
    }
    return {};
  }

  Result<void> write_rows(const LiveSet& set) {
    rows_.clear();
    const std::size_t cameras = devices_.cameras.size();
    for (std::size_t i = 0; i <= cameras + (devices_.depth2 ? 1 : 0); ++i) {
      const auto& timed = set.frames.frames[i];
      if (!timed.frame) continue;
      const std::string& name = i < cameras    ? config_.cameras[i].name
                                : i == cameras ? config_.depth->name
                                               : config_.depth2->name;
      fmt::format_to(std::back_inserter(rows_), "{},{},{},{},{},{:.1f}\n", number_, name,
                     timed.pairing.tick, timed.frame->sequence,
                     timed.mid_exposure.time_since_epoch().count(),
                     seconds(timed.pairing.residual) * 1e6);
    }
    MIXRIG_TRY(writer_.append(kTicks, kTicksColumns, rows_));
    if (!set.pan_tilt) return {};
    rows_.clear();
    fmt::format_to(std::back_inserter(rows_), "{},{:.6f},{:.6f}\n", number_, set.pan_tilt->pan_rad,
                   set.pan_tilt->tilt_rad);
    return writer_.append(kHead, kHeadColumns, rows_);
  }

  struct Extra {
    capture::ColorDecoder decoder;
    Image<Rgb8> picture;
    int count = 0;
    std::uint64_t last = 0;
  };
  const RigConfig& config_;
  const Devices& devices_;
  std::unique_ptr<LensStream> lens_;  ///< null for a rig without [lens]
  SetDecoder decoder_;
  take::TakeWriter writer_;
  capture::Capture frame_;
  std::vector<Extra> extra_;
  std::string rows_;  ///< of a frame, reused
  fs::path reserve_;
  HostTime first_{};
  int number_ = 0;
};

/// Records sets until a condition ends the recording; returns the reason.
Result<std::string> record_sets(LiveSession& session, Recorder& recorder,
                                const RecordOptions& options, const std::atomic<bool>& stop,
                                Clock& clock, std::uint64_t& left_out) {
  const auto free_bytes = options.free_bytes ? options.free_bytes : free_bytes_at;
  const HostTime begin = clock.now();
  HostTime end = begin + kFirstFrameTimeout;  // the time counts from the first frame on
  while (clock.now() < end) {
    if (stop) return std::string("stopped");
    if (recorder.frames() % kFramesPerDiskCheck == 0 &&
        free_bytes(options.out) < options.least_free_bytes)
      return std::string("disk almost full");
    const bool over = session.ended();
    const auto set = session.next(over ? Duration(0) : kRecordWait);
    if (!set && over) MIXRIG_TRY(session.fault());
    if (!set && over) return std::string("end of the cameras");
    if (!set) continue;
    const bool first = recorder.frames() == 0;
    MIXRIG_ASSIGN(const bool written, recorder.write(*set));
    if (!written) ++left_out;
    if (first && written) end = clock.now() + options.duration;
    if (!first && options.progress)
      options.progress(1 - seconds(end - clock.now()) / seconds(options.duration));
  }
  return std::string(recorder.frames() > 0 ? "duration" : "no frames");
}

}  // namespace

Result<RecordReport> record(LiveSession& session, const RigConfig& config, const Devices& devices,
                            const RecordOptions& options, const std::atomic<bool>& stop,
                            Clock& clock) {
  MIXRIG_ASSIGN(const take::TakeInfo info, take_info(config, devices));
  MIXRIG_ASSIGN(auto writer, take::TakeWriter::create(options.out, info, options.format));
  MIXRIG_ASSIGN(auto lens, LensStream::open(config, devices, clock));
  Recorder recorder(config, devices, std::move(writer), std::move(lens));
  MIXRIG_TRY(recorder.reserve());
  MIXRIG_TRY(recorder.open_tables());
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
  if (!finished && recorded) recorded = finished.error();
  if (!recorded) {
    Error error = std::move(recorded).error();
    error.context += ": the take ends after " + std::to_string(report.frames) + " frames";
    return error;
  }
  return report;
}

}  // namespace mixrig::live

// SPDX-License-Identifier: Apache-2.0
#include "host/rig/record.h"

#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>

#include "host/image_io/image_io.h"
#include "host/rig/decode.h"

namespace mixrig::rig {
namespace fs = std::filesystem;

namespace {

constexpr Duration kWait = std::chrono::milliseconds(200);
constexpr Duration kPatience = std::chrono::seconds(5);  // until the first frame
constexpr int kFramesPerLook = 10;                       // at the free disk

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

geometry::CameraModel guess(Size size) {
  const double focal_px = 0.5 * size.width / std::tan(std::numbers::pi / 6);
  return {.pinhole = {.size_px = size,
                      .fx_px = focal_px,
                      .fy_px = focal_px,
                      .cx_px = 0.5 * (size.width - 1),
                      .cy_px = 0.5 * (size.height - 1)},
          .lens = {}};
}

geometry::CameraModel depth_model(const device::DepthCamera& depth) {
  geometry::CameraModel model = guess(depth.info().size);
  if (const auto& told = depth.depth().intrinsics) {
    model.pinhole.fx_px = model.pinhole.fy_px = told->focal_px;
    model.pinhole.cx_px = told->principal_x_px;
    model.pinhole.cy_px = told->principal_y_px;
  }
  return model;
}

std::uint64_t free_bytes_at(const fs::path& path) {
  std::error_code error;
  const auto folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const auto space = fs::space(folder, error);
  return error ? 0 : space.available;
}

/// Writes sets; one object per recording.
class Recorder {
 public:
  Recorder(const RigConfig& config, const Devices& devices, take::TakeWriter writer)
      : config_(config),
        devices_(devices),
        writer_(std::move(writer)),
        extra_(config.cameras.size()) {}

  Result<void> open_tables() {
    ticks_.reset(std::fopen((writer_.staging() / "ticks.csv").c_str(), "w"));
    head_.reset(std::fopen((writer_.staging() / "pan_tilt.csv").c_str(), "w"));
    if (!ticks_ || !head_)
      return Error{ErrorCode::kIo, "cannot write tables into '" + writer_.staging().string() + "'"};
    std::fputs("frame,stream,tick,counter,mid_exposure_ns,residual_us\n", ticks_.get());
    std::fputs("frame,pan_rad,tilt_rad\n", head_.get());
    return {};
  }

  /// False where the set is not fit for a take.
  Result<bool> write(const LiveSet& set) {
    const std::size_t depth_stream = devices_.cameras.size();
    const auto& color = set.frames.frames[0];
    const auto& depth = set.frames.frames[depth_stream];
    if (!color.frame || !depth.frame || !decode_rgb8(*color.frame, frame_.color)) return false;
    if (!device::to_metres(*depth.frame, devices_.depth->depth(), frame_.depth_m)) return false;
    fill_amplitude(*depth.frame);
    if (number_ == 0) first_ = color.mid_exposure;
    frame_.number = ++number_;
    frame_.time_s = seconds(color.mid_exposure - first_);
    MIXRIG_TRY(writer_.write(frame_));
    MIXRIG_TRY(write_others(set));
    return write_rows(set) ? Result<bool>(true)
                           : Error{ErrorCode::kIo, "cannot write ticks.csv: is the disk full?"};
  }

  Result<void> finish() {
    ticks_.reset();
    head_.reset();
    return writer_.finish();
  }
  int frames() const { return number_; }

 private:
  void fill_amplitude(const device::Frame& depth) {
    if (depth.amplitude.size() < 2 * depth.size.area()) return;
    if (frame_.amplitude.size() != depth.size) frame_.amplitude.reset(depth.size);
    const std::uint8_t* in = depth.amplitude.data();
    for (int y = 0; y < depth.size.height; ++y)
      for (int x = 0; x < depth.size.width; ++x, in += 2)
        frame_.amplitude.row(y)[x] = static_cast<float>(in[0] | in[1] << 8);
  }

  /// Further cameras, each new frame of theirs once.
  Result<void> write_others(const LiveSet& set) {
    for (std::size_t i = 1; i < devices_.cameras.size(); ++i) {
      const auto& timed = set.frames.frames[i];
      Extra& extra = extra_[i];
      if (!timed.frame || (extra.count > 0 && timed.frame->sequence == extra.last)) continue;
      if (!decode_rgb8(*timed.frame, extra.picture)) continue;
      const fs::path folder = writer_.staging() / config_.cameras[i].name;
      std::error_code ignored;  // a folder that is missing shows when the picture is written
      if (extra.count == 0) fs::create_directories(folder, ignored);
      char name[32];
      std::snprintf(name, sizeof name, "%06d.png", ++extra.count);
      extra.last = timed.frame->sequence;
      MIXRIG_TRY(image_io::write_png(folder / name, extra.picture.view()));
    }
    return {};
  }

  bool write_rows(const LiveSet& set) {
    bool fine = true;
    for (std::size_t i = 0; i <= devices_.cameras.size(); ++i) {
      const auto& timed = set.frames.frames[i];
      if (!timed.frame) continue;
      const bool depth = i == devices_.cameras.size();
      fine &= std::fprintf(ticks_.get(), "%d,%s,%llu,%llu,%lld,%.1f\n", number_,
                           (depth ? config_.depth->name : config_.cameras[i].name).c_str(),
                           static_cast<unsigned long long>(timed.pairing.tick),
                           static_cast<unsigned long long>(timed.frame->sequence),
                           static_cast<long long>(timed.mid_exposure.time_since_epoch().count()),
                           seconds(timed.pairing.residual) * 1e6) > 0;
    }
    if (set.pan_tilt)
      fine &= std::fprintf(head_.get(), "%d,%.6f,%.6f\n", number_, set.pan_tilt->pan_rad,
                           set.pan_tilt->tilt_rad) > 0;
    return fine;
  }

  struct Extra {
    Image<Rgb8> picture;
    int count = 0;
    std::uint64_t last = 0;
  };
  const RigConfig& config_;
  const Devices& devices_;
  take::TakeWriter writer_;
  take::TakeFrame frame_;
  std::vector<Extra> extra_;
  File ticks_, head_;
  HostTime first_{};
  int number_ = 0;
};

/// Takes sets until something ends it; returns the reason.
Result<std::string> record_sets(LiveSession& session, Recorder& recorder,
                                const RecordOptions& options, const std::atomic<bool>& stop,
                                Clock& clock, std::uint64_t& left_out) {
  const auto free_bytes = options.free_bytes ? options.free_bytes : free_bytes_at;
  const HostTime begin = clock.now();
  HostTime end = begin + kPatience;  // the time counts from the first frame on
  while (clock.now() < end) {
    if (stop) return std::string("stopped");
    if (recorder.frames() % kFramesPerLook == 0 &&
        free_bytes(options.out) < options.least_free_bytes)
      return std::string("disk almost full");
    const auto set = session.next(kWait);
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

take::TakeInfo take_info(const RigConfig& config, const Devices& devices) {
  take::TakeInfo info;
  info.name = config.name;
  info.target = config.target ? *config.target : guess(devices.cameras.front()->info().size);
  info.tof = config.tof ? *config.tof : depth_model(*devices.depth);
  info.target_from_tof = config.target_from_tof;
  const device::DepthInfo& depth = devices.depth->depth();
  info.depth_kind =
      depth.meaning == device::DepthMeaning::kZ ? take::DepthKind::kZ : take::DepthKind::kDistance;
  info.depth_unit_m = depth.metres_per_step;
  info.depth_unknown = 0;
  const TriggerLine* line = config.line_of(config.cameras.front());
  info.color.rate_hz =
      line != nullptr ? 100.0 / line->channel.divider : devices.cameras.front()->info().rate_hz;
  info.depth.rate_hz = info.color.rate_hz;
  return info;
}

Result<RecordReport> record(LiveSession& session, const RigConfig& config, const Devices& devices,
                            const RecordOptions& options, const std::atomic<bool>& stop,
                            Clock& clock) {
  if (devices.cameras.empty() || !devices.depth)
    return Error{ErrorCode::kUsage,
                 "a take needs a [[camera]] and a [depth] camera: add them to rig.toml"};
  MIXRIG_ASSIGN(auto writer,
                take::TakeWriter::create(options.out, take_info(config, devices), options.format));
  Recorder recorder(config, devices, std::move(writer));
  MIXRIG_TRY(recorder.open_tables());
  MIXRIG_TRY(session.start());
  RecordReport report;
  auto ended = record_sets(session, recorder, options, stop, clock, report.left_out);
  session.stop();
  report.session = session.report();
  report.frames = recorder.frames();
  if (report.frames == 0)
    return Error{ErrorCode::kDevice,
                 "no frames came from the cameras that could be paired: run mixrig diag"};
  // What was written before an error is kept: a take is whole as far as it goes.
  MIXRIG_TRY(recorder.finish());
  if (!ended) return std::move(ended).error();
  report.ended = *std::move(ended);
  return report;
}

}  // namespace mixrig::rig

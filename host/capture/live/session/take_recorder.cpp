// SPDX-License-Identifier: Apache-2.0
#include "host/capture/live/session/take_recorder.h"

#include <cstdio>
#include <iterator>
#include <memory>

#include <fcntl.h>
#include <fmt/format.h>

#include "host/math/image_io/image_io.h"

namespace mixrig::live {
namespace fs = std::filesystem;

namespace {

constexpr const char *kTicks = "ticks.csv", *kHead = "pan_tilt.csv";
constexpr const char* kTicksColumns = "frame,stream,tick,counter,mid_exposure_ns,residual_us\n";
constexpr const char* kHeadColumns = "frame,pan_rad,tilt_rad\n";
// Space for index and manifest of a take.
constexpr long kReserve_bytes = 4L << 20;

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

}  // namespace

TakeRecorder::TakeRecorder(const RigConfig& config, const Devices& devices, take::TakeWriter writer,
                           LensStream* lens)
    : config_(config),
      devices_(devices),
      lens_(lens),
      decoder_(config, devices),
      writer_(std::move(writer)),
      extra_(config.cameras.size()) {
  for (std::size_t i = 0; i < extra_.size(); ++i)
    extra_[i].decoder =
        capture::ColorDecoder(color_settings(config.cameras[i], devices.cameras[i]->info()));
}

Result<void> TakeRecorder::begin() {
  reserve_ = writer_.staging() / "reserve";
  const File file(std::fopen(reserve_.c_str(), "w"));
  const int failed = file ? ::posix_fallocate(::fileno(file.get()), 0, kReserve_bytes) : errno;
  if (failed != 0)
    return system_error(ErrorCode::kIo,
                        "cannot reserve space for a take in '" + writer_.staging().string() +
                            "': free some, or record elsewhere",
                        failed);
  MIXRIG_TRY(writer_.append(kTicks, kTicksColumns, {}));
  return writer_.append(kHead, kHeadColumns, {});
}

Result<bool> TakeRecorder::write(const LiveSet& set) {
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

Result<void> TakeRecorder::finish() {
  std::error_code ignored;  // a remaining file does no harm
  fs::remove(reserve_, ignored);
  return writer_.finish();
}

/// Writes the frames of the other cameras, each once, except the fisheye, which is in the take.
Result<void> TakeRecorder::write_others(const LiveSet& set) {
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

Result<void> TakeRecorder::write_rows(const LiveSet& set) {
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

}  // namespace mixrig::live

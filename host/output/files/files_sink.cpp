// SPDX-License-Identifier: Apache-2.0
#include "host/output/files/files_sink.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/capture/take/segments/segments.h"
#include "host/math/image_io/image_io.h"
#include "host/output/report/picture.h"

namespace mixrig::output {
namespace {

/// The take of the composites: an ideal camera with colour and depth in the view.
take::TakeInfo info_of(const capture::SourceInfo& source, const geometry::Pinhole& view) {
  take::TakeInfo info;
  info.name = source.name + " composite";
  info.rate_hz = info.color.rate_hz = info.depth.rate_hz = source.rate_hz;
  info.target.pinhole = info.tof.pinhole = view;
  info.view = view;
  info.noise = source.noise;
  info.has_poses = true;
  return info;
}

/// Columns of the view of each frame, where the lens zooms; the take of the composites has that at
/// rest.
constexpr const char* kLensColumns =
    ",lens,view_fx_px,view_fy_px,view_cx_px,view_cy_px,pupil_shift_m";
std::string lens_cells(const Composite& composite) {
  const std::optional<capture::FrameLens>& lens = composite.capture->lens;
  const geometry::Pinhole& v = composite.view;
  return fmt::format(",{},{:.4f},{:.4f},{:.4f},{:.4f},{:.6f}",
                     capture::name(lens ? lens->origin : capture::LensOrigin::kFixed), v.fx_px,
                     v.fy_px, v.cx_px, v.cy_px, lens ? lens->state.pupil_shift_m : 0.0);
}

/// Cell of a table; empty where the value is unknown.
std::string cell(const std::optional<double>& value) {
  return value ? fmt::format("{:.4f}", *value) : std::string();
}

Result<void> make_folder(const std::filesystem::path& folder) {
  std::error_code code;
  if (std::filesystem::create_directories(folder, code)) return {};
  return system_error(ErrorCode::kIo, "cannot make folder " + folder.string(), code.value());
}

void to_millimetres(const Image<float>& depth_m, Image<std::uint16_t>& mm) {
  mm.reset(depth_m.size());
  for (int y = 0; y < mm.height(); ++y)
    for (int x = 0; x < mm.width(); ++x)
      mm.row(y)[x] = static_cast<std::uint16_t>(
          std::lround(std::clamp(depth_m.row(y)[x] * 1e3F, 0.0F, 65535.0F)));
}

}  // namespace

Result<std::unique_ptr<FilesSink>> FilesSink::create(const std::filesystem::path& folder,
                                                     const capture::SourceInfo& source,
                                                     const geometry::Pinhole& view,
                                                     const OutputOptions& options) {
  std::unique_ptr<FilesSink> sink(new FilesSink(folder, options));
  sink->table_.open(folder / "frames.csv");
  sink->table_ << "frame,tick,time_s,frame_ms,foreground_pct,pose,pose_age_ms,slip_px,slip_sigma_px"
               << (source.lens ? kLensColumns : "") << '\n';
  sink->lens_columns_ = source.lens != nullptr;
  if (options.format == OutputFormat::kNone) return sink;
  sink->info_ = info_of(source, view);
  MIXRIG_TRY(sink->begin_take());
  if (options.alpha) MIXRIG_TRY(make_folder(folder / "alpha"));
  for (const char* name : {"segmented_depth", "matte"})
    if (options.layers) MIXRIG_TRY(make_folder(folder / name));
  for (const char* name : {"warped_depth", "key", "light"})
    if (options.inspect) MIXRIG_TRY(make_folder(folder / name));
  return sink;
}

/// Begins the take of the composites, or its next segment.
Result<void> FilesSink::begin_take() {
  std::filesystem::path path = folder_ / "composite";
  if (options_.segment_s > 0) {
    MIXRIG_ASSIGN(path, take::next_segment(path));
  }
  MIXRIG_ASSIGN(composite_, take::TakeWriter::create(path, info_,
                                                     options_.format == OutputFormat::kVideo
                                                         ? take::StreamFormat::kMatroska
                                                         : take::StreamFormat::kPng));
  segment_began_s_.reset();
  return {};
}

render::OutputMask FilesSink::wanted(int) const {
  if (options_.format == OutputFormat::kNone) return render::kMatte;  // for frames.csv
  render::OutputMask mask = render::kColor | render::kMixedDepth;
  if (options_.alpha) mask |= render::kAlpha;
  if (options_.layers) mask |= render::kSegmentedDepth | render::kMatte;
  if (options_.inspect) mask |= render::kWarpedDepth | render::kState | render::kLight;
  return mask;
}

Result<void> FilesSink::write(const CompositePtr& composite) {
  MIXRIG_TRY(write_row(*composite));
  if (options_.format == OutputFormat::kNone) return {};
  ++frame_.number;
  frame_.time_s = composite->capture->time_s;
  if (options_.segment_s > 0 && segment_began_s_ &&
      frame_.time_s - *segment_began_s_ >= options_.segment_s) {
    MIXRIG_TRY(composite_->finish());
    MIXRIG_TRY(begin_take());
  }
  if (!segment_began_s_) segment_began_s_ = frame_.time_s;
  frame_.plate = composite->images.color;
  frame_.depth_m = composite->images.mixed_depth_m;
  frame_.world_from_target = composite->world_from_target;
  if (const auto& lens = composite->capture->lens)
    frame_.world_from_target =
        geometry::at_pupil(frame_.world_from_target, lens->state.pupil_shift_m);
  MIXRIG_TRY(composite_->write(frame_));
  return write_layers(composite->images);
}

Result<void> FilesSink::write_row(const Composite& composite) {
  const capture::Capture& capture = *composite.capture;
  table_ << fmt::format("{},{},{:.6f},{:.3f},{:.3f},{},{:.3f},{},{}{}\n", capture.number,
                        capture.tick, capture.time_s, composite.frame_ms, composite.foreground_pct,
                        capture::name(composite.pose.loss), 1e3 * composite.pose.age_s,
                        cell(composite.slip_px), cell(composite.slip_sigma_px),
                        lens_columns_ ? lens_cells(composite) : std::string());
  if (table_) return {};
  return system_error(
      ErrorCode::kIo,
      "cannot write '" + (folder_ / "frames.csv").string() + "': check the disk's free space",
      errno);
}

Result<void> FilesSink::write_layers(const render::FrameOutput& images) {
  const std::string name = fmt::format("{:06}.png", frame_.number);
  if (options_.alpha) MIXRIG_TRY(image_io::write_png(folder_ / "alpha" / name, images.alpha));
  if (options_.layers) {
    to_millimetres(images.segmented_depth_m, depth_mm_);
    MIXRIG_TRY(image_io::write_png(folder_ / "segmented_depth" / name, depth_mm_.view()));
    MIXRIG_TRY(image_io::write_png(folder_ / "matte" / name, images.matte.view()));
  }
  if (options_.inspect) {
    to_millimetres(images.warped_depth_m, depth_mm_);
    MIXRIG_TRY(image_io::write_png(folder_ / "warped_depth" / name, depth_mm_.view()));
    MIXRIG_TRY(
        image_io::write_png(folder_ / "key" / name, report::key_picture(images.state).view()));
    MIXRIG_TRY(
        image_io::write_png(folder_ / "light" / name, report::light_picture(images.light).view()));
  }
  return {};
}

Result<void> FilesSink::finish() {
  table_.close();
  return composite_ ? composite_->finish() : Result<void>();
}

}  // namespace mixrig::output

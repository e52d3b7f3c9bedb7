// SPDX-License-Identifier: Apache-2.0
#include "host/app/run_writer.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host/app/picture.h"
#include "host/image_io/image_io.h"

namespace mixrig::app {
namespace {

/// The composite's take: an ideal camera that sees colour and depth in the view.
take::TakeInfo info_of(const take::TakeInfo& source, const geometry::Pinhole& view) {
  take::TakeInfo info;
  info.name = source.name + " composite";
  info.color.rate_hz = info.depth.rate_hz = source.color.rate_hz;
  info.target.pinhole = info.tof.pinhole = view;
  info.view = view;
  info.noise = source.noise;
  info.has_poses = true;
  return info;
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

Result<RunWriter> RunWriter::create(const std::filesystem::path& folder,
                                    const take::TakeInfo& source, const geometry::Pinhole& view,
                                    const OutputOptions& options) {
  RunWriter writer(folder, options);
  if (options.format == OutputFormat::kNone) return writer;
  MIXRIG_ASSIGN(writer.composite_,
                take::TakeWriter::create(folder / "composite", info_of(source, view),
                                         options.format == OutputFormat::kVideo
                                             ? take::StreamFormat::kMatroska
                                             : take::StreamFormat::kPng));
  for (const char* name : {"segmented_depth", "matte"})
    if (options.layers) MIXRIG_TRY(make_folder(folder / name));
  for (const char* name : {"warped_depth", "key", "light"})
    if (options.inspect) MIXRIG_TRY(make_folder(folder / name));
  return writer;
}

Result<void> RunWriter::write(const take::TakeFrame& input, const geometry::Pose& world_from_target,
                              const render::FrameOutput& output) {
  if (options_.format == OutputFormat::kNone) return {};
  ++frame_.number;
  frame_.time_s = input.time_s;
  frame_.color = output.color;
  frame_.depth_m = output.mixed_depth_m;
  frame_.world_from_target = world_from_target;
  MIXRIG_TRY(composite_->write(frame_));
  return write_layers(output);
}

Result<void> RunWriter::write_layers(const render::FrameOutput& output) {
  char name[16];
  std::snprintf(name, sizeof name, "%06d.png", frame_.number);
  if (options_.layers) {
    to_millimetres(output.segmented_depth_m, depth_mm_);
    MIXRIG_TRY(image_io::write_png(folder_ / "segmented_depth" / name, depth_mm_.view()));
    MIXRIG_TRY(image_io::write_png(folder_ / "matte" / name, output.matte.view()));
  }
  if (options_.inspect) {
    to_millimetres(output.warped_depth_m, depth_mm_);
    MIXRIG_TRY(image_io::write_png(folder_ / "warped_depth" / name, depth_mm_.view()));
    MIXRIG_TRY(image_io::write_png(folder_ / "key" / name, key_picture(output.state).view()));
    MIXRIG_TRY(image_io::write_png(folder_ / "light" / name, light_picture(output.light).view()));
  }
  return {};
}

Result<void> RunWriter::finish() {
  if (composite_) return composite_->finish();
  return {};
}

}  // namespace mixrig::app

// SPDX-License-Identifier: Apache-2.0
// Writes what a run composites: a take of composite and mixed depth, further layers as pictures.
#pragma once

#include <filesystem>
#include <optional>

#include "hal/base/result.h"
#include "host/geometry/camera_model.h"
#include "host/render/compositor.h"
#include "host/take/take.h"

namespace mixrig::app {

enum class OutputFormat { kPng, kVideo, kNone };

struct OutputOptions {
  OutputFormat format = OutputFormat::kPng;  ///< of the composite; kNone writes no frames at all
  bool layers = false;                       ///< segmented depth (millimetres) and matte too
  bool inspect = false;                      ///< warped depth, key and light map too
};

/// Lays out a run's folder: composite/ (a take: colour is the composite, depth the mixed depth, in
/// the view), segmented_depth/, matte/, warped_depth/, key/, light/ with PNGs numbered from 1.
/// Errors: kIo. Not thread-safe.
class RunWriter {
 public:
  static Result<RunWriter> create(const std::filesystem::path& folder, const take::TakeInfo& source,
                                  const geometry::Pinhole& view, const OutputOptions& options);
  /// `output` holds inspection images where options.inspect was set.
  Result<void> write(const take::TakeFrame& input, const geometry::Pose& world_from_target,
                     const render::FrameOutput& output);
  Result<void> finish();

 private:
  RunWriter(std::filesystem::path folder, OutputOptions options)
      : folder_(std::move(folder)), options_(options) {}
  Result<void> write_layers(const render::FrameOutput& output);

  std::filesystem::path folder_;
  OutputOptions options_;
  std::optional<take::TakeWriter> composite_;
  take::TakeFrame frame_;
  Image<std::uint16_t> depth_mm_;
};

}  // namespace mixrig::app

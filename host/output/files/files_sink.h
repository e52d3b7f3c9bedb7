// SPDX-License-Identifier: Apache-2.0
// Writes composites: a take of composite and mixed depth, further layers as pictures.
#pragma once

#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>

#include "hal/base/result.h"
#include "host/capture/capture/capture_source.h"
#include "host/capture/take/take.h"
#include "host/math/geometry/camera_model.h"
#include "host/output/sink/composite_sink.h"

namespace mixrig::output {

enum class OutputFormat { kPng, kVideo, kNone };

struct OutputOptions {
  OutputFormat format = OutputFormat::kPng;  ///< of the composite; kNone writes no frames at all
  bool layers = false;                       ///< segmented depth (millimetres) and matte too
  bool inspect = false;                      ///< warped depth, key and light map too
  bool alpha = false;  ///< share of a pixel that is covered: the composite is over black
};

/// Fills a run's folder: composite/ (a take: colour is the composite, depth the mixed depth, in the
/// view), alpha/ where the set leaves parts transparent, segmented_depth/, matte/, warped_depth/,
/// key/, light/ with PNGs numbered from 1, and frames.csv with a row for each frame.
class FilesSink final : public CompositeSink {
 public:
  /// `folder` exists. Errors: kIo.
  static Result<std::unique_ptr<FilesSink>> create(const std::filesystem::path& folder,
                                                   const capture::SourceInfo& source,
                                                   const geometry::Pinhole& view,
                                                   const OutputOptions& options);
  std::string_view name() const override { return "files"; }
  render::OutputMask wanted(int number) const override;
  Result<void> write(const CompositePtr& composite) override;
  Result<void> finish() override;

 private:
  FilesSink(std::filesystem::path folder, OutputOptions options)
      : folder_(std::move(folder)), options_(options) {}
  Result<void> write_row(const Composite& composite);
  Result<void> write_layers(const render::FrameOutput& images);

  std::filesystem::path folder_;
  OutputOptions options_;
  std::optional<take::TakeWriter> composite_;
  capture::Capture frame_;
  Image<std::uint16_t> depth_mm_;
  std::ofstream table_;
  bool lens_columns_ = false;  ///< of table_
};

}  // namespace mixrig::output

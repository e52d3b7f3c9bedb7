// SPDX-License-Identifier: Apache-2.0
// Writes composites to files: a take of composite and mixed depth, and other layers as pictures.
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
  OutputFormat format = OutputFormat::kPng;  ///< of the composite; kNone: no frames are written
  bool layers = false;                       ///< also segmented depth (millimetres) and matte
  bool inspect = false;                      ///< also warped depth, key and light map
  double segment_s = 0;  ///< the composite goes on in a new take (take/segments/segments.h); 0: one take
  bool alpha = false;    ///< also the covered share of each pixel: the composite is over black
};

/// Fills a run's folder: composite/ (a take with the composite as colour and the mixed depth as
/// depth, in the view; or segments of it), alpha/ if the set leaves parts transparent,
/// segmented_depth/, matte/, warped_depth/, key/, light/ with PNGs numbered from 1, and frames.csv
/// with a row for each frame.
class FilesSink final : public CompositeSink {
 public:
  /// Precondition: `folder` exists. Errors: kIo.
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
  Result<void> begin_take();
  Result<void> write_row(const Composite& composite);
  Result<void> write_layers(const render::FrameOutput& images);

  std::filesystem::path folder_;
  OutputOptions options_;
  take::TakeInfo info_;
  std::optional<take::TakeWriter> composite_;
  std::optional<double> segment_began_s_;  ///< time of the first frame of the running segment
  capture::Capture frame_;
  Image<std::uint16_t> depth_mm_;
  std::ofstream table_;
  bool lens_columns_ = false;  ///< table_ has columns for the lens
};

}  // namespace mixrig::output

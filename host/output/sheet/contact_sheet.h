// SPDX-License-Identifier: Apache-2.0
// A contact sheet: one row per frame of a run, with inputs and outputs of the compositor.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hal/base/image.h"
#include "host/output/sink/composite_sink.h"

namespace mixrig::output {

/// Collects rows of thumbnails: input, depth, key, light map, composite and, where known, truth and
/// the largest wrong piece, enlarged: left composite, right truth.
class ContactSheet {
 public:
  /// Images that a row needs.
  static constexpr render::OutputMask kWanted =
      render::kColor | render::kWarpedDepth | render::kState | render::kLight;
  explicit ContactSheet(std::string title) : title_(std::move(title)) {}

  /// Adds a row. `output` holds the images of kWanted; `truth` may be empty; `worst` is unset if
  /// the frame is not judged.
  void add_row(int frame, ImageView<const Rgb8> plate, const render::FrameOutput& output,
               ImageView<const Rgb8> truth, const std::optional<WrongPiece>& worst);
  bool empty() const { return rows_.empty(); }
  Image<Rgb8> draw() const;

 private:
  struct Row {
    int frame;
    std::vector<Image<Rgb8>> pictures;
  };
  std::string title_;
  std::vector<Row> rows_;
  float near_m_ = 0, far_m_ = 1;  ///< depth range of the first row, so that colours are comparable
};

/// `count` frame numbers spread evenly over first..last; all of them if there are fewer.
std::vector<int> spread(int first, int last, int count);

}  // namespace mixrig::output

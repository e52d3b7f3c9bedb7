// SPDX-License-Identifier: Apache-2.0
// Lossless Matroska streams (FFV1) through GStreamer. Private to this module.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <optional>

#include "host/capture/take/streams/gst_pipeline.h"
#include "host/capture/take/streams/picture_stream.h"

namespace mixrig::take {

/// GStreamer's name of the raw format that FFV1 stores without loss.
const char* raw_format(PixelKind kind);

/// Opens a file of `count` frames at `rate_hz`. Errors: kNotFound, kUnsupported.
Result<std::unique_ptr<PictureStream>> open_matroska(const std::filesystem::path& path,
                                                     PixelKind kind, int count, double rate_hz);

/// Writes one stream. Frames of one size. Not thread-safe.
class MatroskaWriter {
 public:
  /// Creates the file. Errors: kUnsupported, kIo.
  static Result<MatroskaWriter> create(const std::filesystem::path& path, PixelKind kind, Size size,
                                       double rate_hz);
  /// Appends a frame; waits only while the pipeline works on earlier ones. Errors: kData for
  /// another size, kIo.
  Result<void> write(ImageView<const Rgb8> image);
  Result<void> write(ImageView<const std::uint16_t> image);
  /// Completes the file; without it the file is incomplete. Errors: kIo, also what write() has
  /// returned.
  Result<void> finish();

 private:
  MatroskaWriter(Pipeline pipeline, GstElementPtr source, Size size, double rate_hz,
                 std::string name)
      : pipeline_(std::move(pipeline)),
        source_(std::move(source)),
        size_(size),
        rate_hz_(rate_hz),
        name_(std::move(name)) {}
  template <typename T, typename Fill>
  Result<void> push(ImageView<const T> image, std::size_t bytes_per_pixel, Fill fill_row);
  Error refused(const std::string& otherwise);
  std::uint64_t young_frames();

  Pipeline pipeline_;
  GstElementPtr source_;
  Size size_;
  double rate_hz_;
  std::string name_;
  int frames_ = 0;
  std::deque<std::chrono::steady_clock::time_point> pushed_;  ///< of the last half second
  std::optional<Error> failed_;  ///< what write() has returned: nothing more is taken
};

}  // namespace mixrig::take

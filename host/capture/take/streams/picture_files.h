// SPDX-License-Identifier: Apache-2.0
// Streams of picture files: numbered, or listed. Private to this module.
#pragma once

#include <filesystem>
#include <functional>

#include "host/capture/take/streams/picture_stream.h"

namespace mixrig::take {

/// A file name with one number in it, such as "color/%06d.png". The pattern is not passed to
/// printf.
class NumberedName {
 public:
  /// Parses a pattern. Errors: kFormat unless there is exactly one %d or %0Nd, N at most 9.
  static Result<NumberedName> parse(const std::string& pattern);
  std::string with(int number) const;

 private:
  std::string before_, after_;
  std::size_t digits_ = 0;
};

/// Picture files, one per index. PNG and JPEG are told apart by content; of an .exr file the
/// channel Z or the only one is read.
class PictureFiles final : public PictureStream {
 public:
  using PathOf = std::function<std::filesystem::path(int index)>;
  /// `needs_16_bits`: pictures of 8 bits are refused, as depth needs it.
  explicit PictureFiles(PathOf path_of, bool needs_16_bits = false)
      : path_of_(std::move(path_of)), needs_16_bits_(needs_16_bits) {}

  std::string name(int index) const override { return path_of_(index).string(); }
  Result<void> read(int index, Image<Rgb8>& image) override;
  Result<void> read(int index, Image<std::uint16_t>& image) override;
  bool holds_float() const override { return path_of_(0).extension() == ".exr"; }
  Result<void> read(int index, Image<float>& image) override;

 private:
  PathOf path_of_;
  bool needs_16_bits_;
};

}  // namespace mixrig::take

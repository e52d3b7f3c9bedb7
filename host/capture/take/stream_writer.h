// SPDX-License-Identifier: Apache-2.0
// One stream of a take that is being written. Private to this module.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "host/capture/take/disk_sync.h"
#include "host/capture/take/streams/matroska.h"
#include "host/capture/take/take.h"
#include "host/math/image_io/image_io.h"

namespace mixrig::take {

inline std::string number_name(int number) { return fmt::format("{:06d}.png", number); }

inline Result<void> make_take_folder(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (!error) return {};
  return system_error(ErrorCode::kIo, "cannot make folder '" + path.string() + "'", error.value());
}

/// One 16-bit or colour stream, as pictures or as a Matroska file. Not thread-safe.
class StreamWriter {
 public:
  /// Files go to the disk by `disk`, which must outlive this.
  StreamWriter(std::filesystem::path folder, const char* name, PixelKind kind, StreamFormat format,
               double rate_hz, DiskSync& disk)
      : folder_(std::move(folder)),
        name_(name),
        kind_(kind),
        format_(format),
        rate_hz_(rate_hz),
        disk_(disk) {}

  template <typename T>
  Result<void> write(ImageView<const T> image) {
    ++count_;
    if (format_ == StreamFormat::kPng) {
      if (count_ == 1) MIXRIG_TRY(make_take_folder(folder_ / name_));
      const std::filesystem::path file = folder_ / name_ / number_name(count_);
      MIXRIG_TRY(image_io::write_png(file, image));
      disk_.wrote(file);
      return {};
    }
    if (!matroska_) {
      const std::filesystem::path file = folder_ / (name_ + ".mkv");
      MIXRIG_ASSIGN(auto writer, MatroskaWriter::create(file, kind_, image.size, rate_hz_));
      matroska_ = std::make_unique<MatroskaWriter>(std::move(writer));
      disk_.grows(file);
    }
    return matroska_->write(image);
  }

  /// Ends the file, also after an error, which is returned. Errors: those of MatroskaWriter.
  Result<void> finish() {
    Result<void> done = matroska_ ? matroska_->finish() : Result<void>();
    matroska_.reset();
    return done;
  }

  StreamInfo info() const {
    return {format_ == StreamFormat::kPng ? name_ + "/%06d.png" : name_ + ".mkv", 1, count_,
            rate_hz_};
  }

 private:
  std::filesystem::path folder_;
  std::string name_;
  PixelKind kind_;
  StreamFormat format_;
  double rate_hz_;
  DiskSync& disk_;
  int count_ = 0;
  std::unique_ptr<MatroskaWriter> matroska_;
};

}  // namespace mixrig::take

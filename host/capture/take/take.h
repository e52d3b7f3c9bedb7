// SPDX-License-Identifier: Apache-2.0
// Takes: recordings of a rig with their calibration. docs/reference/take.md describes take.toml.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/image.h"
#include "hal/base/result.h"
#include "host/capture/capture/capture_source.h"

namespace mixrig::take {

/// One stream as the manifest describes it. `path` holds one %d conversion (numbered pictures) or
/// names a Matroska file.
struct StreamInfo {
  std::string path;
  int first = 1;  ///< number in the first file's name
  int count = 0;
  double rate_hz = 0;  ///< 0 where unknown
  double delay_s = 0;  ///< depth only: its mid-exposure minus that of colour
  bool operator==(const StreamInfo&) const = default;
};

/// Streams of a second depth camera, SourceInfo::tof2.
struct SecondDepthStream {
  StreamInfo depth;
  std::optional<StreamInfo> amplitude;
};

/// The manifest: what every source has, and the streams of a take.
struct TakeInfo : capture::SourceInfo {
  std::filesystem::path path;  ///< folder or manifest that was opened
  std::filesystem::path root;  ///< folder that stream paths are relative to
  StreamInfo color, depth;
  std::optional<StreamInfo> amplitude;
  std::optional<StreamInfo> fisheye;        ///< has its own rate; its stamps are in fisheye.csv
  std::optional<SecondDepthStream> depth2;  ///< only with tof2, and tof2 only with it
  int depth_unknown = 0;
  std::string raw_depth;  ///< "kinect2": the stream `depth` holds raw frames; empty: pictures
  double truth_depth_unit_m = 0.00025;
  int segments =
      1;  ///< takes that were joined (segments/segments.h); counts and times are those of all
};

/// Reads a take folder, a take.toml, a TUM RGB-D folder, or a folder of takes that follow each
/// other (segments/segments.h) as one. Not thread-safe.
class TakeReader {
 public:
  /// Opens a take. Errors: kNotFound, kFormat (file:line: key ...), kData (calibration, sizes, no
  /// frames, segments of other cameras).
  static Result<TakeReader> open(const std::filesystem::path& path);
  TakeReader(TakeReader&&) noexcept;
  TakeReader& operator=(TakeReader&&) noexcept;
  ~TakeReader();

  const TakeInfo& info() const;
  /// Reads frame `number` (1..frames), reusing the memory of `frame`. Its fisheye picture follows
  /// capture::fisheye_status().
  /// Errors: kNotFound, kFormat, kData; the line names the file.
  Result<void> read(int number, capture::Capture& frame);
  /// Reads the truth of frame `number`. Errors: those of read(); kNotFound if the take has no
  /// truth.
  Result<void> read_truth(int number, capture::Truth& truth);

 private:
  struct State;
  explicit TakeReader(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

enum class StreamFormat { kPng, kMatroska };

/// Writes a take folder. All files go into OUT.partial, which finish() renames to OUT. From the
/// first frame on OUT.partial is a take that TakeReader opens; every second what was written is
/// brought to the disk, in a thread of the writer. A writer that is destroyed before finish()
/// leaves OUT.partial if a frame was written, else nothing. Not thread-safe.
class TakeWriter {
 public:
  /// Creates a take. `info` gives cameras, rig, depth units and rates; the writer sets counts and
  /// paths, and copies the file info.calibration into the take.
  /// Errors: kUsage if `folder` exists and is not a take, or if OUT.partial holds what is left of
  /// one; kIo, kNotFound.
  static Result<TakeWriter> create(const std::filesystem::path& folder, const TakeInfo& info,
                                   StreamFormat format);
  TakeWriter(TakeWriter&&) noexcept;
  TakeWriter& operator=(TakeWriter&&) noexcept;
  ~TakeWriter();

  /// Writes a frame. For a take with raw_depth it writes neither depth nor amplitude: the caller
  /// puts raw/%06d.bin and its tables into staging(). The fisheye's picture and the encoder values
  /// of the lens are written only if their stamp is later than the last.
  Result<void> write(const capture::Capture& frame);
  Result<void> write_truth(const capture::Truth& truth);  ///< after write() of the same frame
  /// Appends whole rows to a further table, which the first call makes with its header. Errors:
  /// kIo.
  Result<void> append(const char* table, const char* header, std::string_view rows);
  /// A further file in staging() that is to be brought to the disk with the take.
  void wrote(const std::filesystem::path& file);
  /// Folder for further files (scene.toml, models) before finish().
  const std::filesystem::path& staging() const;
  /// Drops what was written: for takes that can be made again.
  void discard();
  /// Completes the take, also after an error of write(): it then holds the frames that are whole.
  /// Errors: kIo, kData without a frame, those of the streams. If a stream could not be ended the
  /// take is there all the same.
  Result<void> finish();

 private:
  struct State;
  explicit TakeWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace mixrig::take

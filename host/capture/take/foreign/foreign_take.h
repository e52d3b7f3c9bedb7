// SPDX-License-Identifier: Apache-2.0
// A take made of pictures as another program stored them. Private to this module.
#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "hal/base/partial_path.h"
#include "host/capture/take/take.h"
#include "host/capture/take/trajectory.h"

namespace mixrig::take {

/// What was made into a take.
struct Imported {
  std::string kind;                  ///< "a recording of an Azure Kinect"
  int color = 0, depth = 0;          ///< pictures
  int frames = 0;                    ///< pairs of them
  std::vector<std::string> assumed;  ///< what the recording does not state
  std::vector<std::string> lost;     ///< what it has beside, or has damaged
};

/// Writes a folder with take.toml, rgb.txt, depth.txt, poses.txt and the pictures, whole or not at
/// all. Pictures may come in any order. Not thread-safe.
class ForeignTake {
 public:
  enum class Stream { kColor, kDepth };

  /// Errors: kUsage where `out` may not be replaced; kIo.
  static Result<ForeignTake> create(const std::filesystem::path& out);

  /// Adds a picture file by its bytes, PNG or JPEG. Errors: kFormat for another kind, kIo.
  Result<void> add(Stream stream, double time_s, std::span<const std::uint8_t> file);
  /// Adds a picture file. Errors: those of add(), kNotFound.
  Result<void> copy(Stream stream, double time_s, const std::filesystem::path& file);
  Result<void> add_color(double time_s, ImageView<const Rgb8> image);
  Result<void> add_depth(double time_s, ImageView<const std::uint16_t> steps);
  void add_pose(double time_s, const geometry::Pose& world_from_target);

  TakeInfo info;  ///< cameras and depth steps; the caller sets them
  std::vector<int> further_unknown;
  Imported told;

  /// Completes the take, opens it and reads its first frame. Errors: those of TakeReader.
  Result<Imported> finish();

 private:
  explicit ForeignTake(PartialPath partial) : partial_(std::move(partial)) {}
  std::string next_name(Stream stream, double time_s, const char* ending);
  Result<void> write_tables();

  PartialPath partial_;
  std::vector<StampedFile> color_, depth_;
  std::vector<StampedPose> poses_;
};

/// Puts the file's name before an error's words.
Result<void> named(const std::filesystem::path& file, Result<void> done);

/// A kind of recording: whether a file or folder is one, and what makes a take of it.
struct ForeignKind {
  bool (*matches)(const std::filesystem::path& source);
  Result<void> (*read)(const std::filesystem::path& source, ForeignTake& take);
};

bool is_kinect_file(const std::filesystem::path& source);
Result<void> read_kinect_file(const std::filesystem::path& source, ForeignTake& take);
bool is_stamped_folder(const std::filesystem::path& source);
Result<void> read_stamped_folder(const std::filesystem::path& source, ForeignTake& take);
bool is_seven_scenes_folder(const std::filesystem::path& source);
Result<void> read_seven_scenes_folder(const std::filesystem::path& source, ForeignTake& take);
bool is_scannet_folder(const std::filesystem::path& source);
Result<void> read_scannet_folder(const std::filesystem::path& source, ForeignTake& take);
bool is_ros_bag(const std::filesystem::path& source);
Result<void> read_ros_bag(const std::filesystem::path& source, ForeignTake& take);

}  // namespace mixrig::take

// SPDX-License-Identifier: Apache-2.0
#include "host/capture/take/foreign/foreign_take.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "host/capture/take/manifest.h"
#include "host/math/image_io/image_io.h"

namespace mixrig::take {
namespace fs = std::filesystem;

namespace {

constexpr const char *kColorFolder = "color", *kDepthFolder = "depth";

/// ".png" or ".jpg" by the first bytes; nullptr for anything else.
const char* ending_of(std::span<const std::uint8_t> file) {
  const auto begins = [&](std::initializer_list<std::uint8_t> with) {
    return file.size() > with.size() && std::equal(with.begin(), with.end(), file.begin());
  };
  if (begins({0x89, 'P', 'N', 'G'})) return ".png";
  return begins({0xFF, 0xD8, 0xFF}) ? ".jpg" : nullptr;
}

/// A time in whole nanoseconds: stamps of pictures and poses that are one stay one as text.
double rounded_s(double time_s) {
  constexpr double kMost_s = 1e6;  // later ones have no digits to spare
  return std::abs(time_s) < kMost_s ? std::round(time_s * 1e9) / 1e9 : time_s;
}

std::string list_text(std::vector<StampedFile>& files) {
  std::ranges::stable_sort(files, {}, &StampedFile::time_s);
  std::string text = "# seconds file\n";
  for (const StampedFile& file : files) text += fmt::format("{} {}\n", file.time_s, file.path);
  return text;
}

}  // namespace

Result<void> named(const fs::path& file, Result<void> done) {
  if (done) return done;
  return Error{done.error().code, "'" + file.string() + "': " + done.error().context};
}

Result<ForeignTake> ForeignTake::create(const fs::path& out) {
  MIXRIG_ASSIGN(PartialPath partial, make_partial_folder(out, "take.toml"));
  std::error_code error;
  for (const char* name : {kColorFolder, kDepthFolder})
    if (!fs::create_directory(partial.path() / name, error))
      return system_error(ErrorCode::kIo, "cannot make a folder in '" + out.string() + "'",
                          error.value());
  ForeignTake take(std::move(partial));
  take.info.name = out.has_filename() ? out.filename() : out.parent_path().filename();
  return take;
}

std::string ForeignTake::next_name(Stream stream, double time_s, const char* ending) {
  auto& files = stream == Stream::kColor ? color_ : depth_;
  const char* folder = stream == Stream::kColor ? kColorFolder : kDepthFolder;
  files.push_back({rounded_s(time_s), fmt::format("{}/{:06}{}", folder, files.size() + 1, ending)});
  return files.back().path;
}

Result<void> ForeignTake::add(Stream stream, double time_s, std::span<const std::uint8_t> file) {
  const char* ending = ending_of(file);
  if (ending == nullptr)
    return Error{ErrorCode::kFormat,
                 fmt::format("picture {} of {} is neither PNG nor JPEG: convert the recording",
                             (stream == Stream::kColor ? color_ : depth_).size() + 1,
                             stream == Stream::kColor ? kColorFolder : kDepthFolder)};
  const fs::path path = partial_.path() / next_name(stream, time_s, ending);
  std::ofstream to(path, std::ios::binary);
  to.write(reinterpret_cast<const char*>(file.data()), static_cast<std::streamsize>(file.size()));
  to.close();
  if (to) return {};
  return Error{ErrorCode::kIo, "cannot write '" + path.string() + "': is the disk full?"};
}

Result<void> ForeignTake::copy(Stream stream, double time_s, const fs::path& file) {
  std::ifstream from(file, std::ios::binary);
  std::vector<std::uint8_t> bytes;
  constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 28;
  std::error_code error;
  const auto size = fs::file_size(file, error);
  if (!from || error || size > kMostBytes)
    return Error{ErrorCode::kNotFound, "cannot read '" + file.string() + "': check the recording"};
  bytes.resize(size);
  from.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  return named(file, add(stream, time_s, {bytes.data(), static_cast<std::size_t>(from.gcount())}));
}

Result<void> ForeignTake::add_color(double time_s, ImageView<const Rgb8> image) {
  return image_io::write_png(partial_.path() / next_name(Stream::kColor, time_s, ".png"), image);
}

Result<void> ForeignTake::add_depth(double time_s, ImageView<const std::uint16_t> steps) {
  return image_io::write_png(partial_.path() / next_name(Stream::kDepth, time_s, ".png"), steps);
}

void ForeignTake::add_pose(double time_s, const geometry::Pose& world_from_target) {
  poses_.push_back({rounded_s(time_s), world_from_target});
}

Result<void> ForeignTake::write_tables() {
  const fs::path& folder = partial_.path();
  info.color.path = "rgb.txt", info.depth.path = "depth.txt";
  info.color.count = static_cast<int>(color_.size());
  info.depth.count = static_cast<int>(depth_.size());
  info.has_poses = !poses_.empty();
  MIXRIG_TRY(write_file(folder / "rgb.txt", list_text(color_)));
  MIXRIG_TRY(write_file(folder / "depth.txt", list_text(depth_)));
  if (info.has_poses) {
    std::ranges::sort(poses_, {}, &StampedPose::time_s);
    std::string text = "# t x y z qx qy qz qw\n";
    for (const StampedPose& pose : poses_) text += trajectory_line(pose);
    MIXRIG_TRY(write_file(folder / "poses.txt", text));
  }
  return write_file(folder / "take.toml", manifest_text(info, false, further_unknown));
}

Result<Imported> ForeignTake::finish() {
  for (const auto& [files, what] : {std::pair(&color_, "colour"), std::pair(&depth_, "depth")})
    if (files->empty())
      return Error{ErrorCode::kData,
                   fmt::format("{} without a {} picture: a take has both", told.kind, what)};
  told.color = static_cast<int>(color_.size()), told.depth = static_cast<int>(depth_.size());
  MIXRIG_TRY(write_tables());
  MIXRIG_ASSIGN(TakeReader reader, TakeReader::open(partial_.path()));
  capture::Capture first;
  MIXRIG_TRY(reader.read(1, first));
  told.frames = reader.info().frames;
  if (const int most = std::max(told.color, told.depth); told.frames < most)
    told.lost.push_back(fmt::format("{} pictures without a partner within 20 ms or without a pose",
                                    most - told.frames));
  MIXRIG_TRY(partial_.commit());
  return std::move(told);
}

}  // namespace mixrig::take

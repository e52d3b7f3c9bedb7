// SPDX-License-Identifier: Apache-2.0
#include "host/capture/take/unfinished.h"

#include <algorithm>
#include <cerrno>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include "hal/base/partial_path.h"
#include "host/capture/take/frame_tables.h"
#include "host/capture/take/growing_table.h"
#include "host/capture/take/streams/fisheye_stream.h"
#include "host/capture/take/streams/matroska_end.h"
#include "host/capture/take/streams/picture_files.h"
#include "host/capture/take/take_state.h"
#include "host/capture/take/trajectory.h"
#include "host/math/config/table.h"

namespace mixrig::take {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostManifestText = std::size_t{1} << 20;

/// Files of a numbered stream from its first one on, without a gap.
Result<int> count_files(const fs::path& root, const std::string& path, int first) {
  MIXRIG_ASSIGN(const NumberedName name, NumberedName::parse((root / path).string()));
  std::error_code error;
  int count = 0;
  while (fs::exists(name.with(first + count), error)) ++count;
  return count;
}

Result<int> count_pictures(const fs::path& root, const StreamInfo& stream) {
  if (!is_matroska(stream)) return count_files(root, stream.path, stream.first);
  MIXRIG_ASSIGN(const MatroskaEnd end, find_matroska_end(root / stream.path));
  return end.frames;
}

/// The whole rows of a table; nullopt where it is not there.
Result<std::optional<std::string>> rows_of(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) return std::optional<std::string>();
  MIXRIG_ASSIGN(const std::string text, config::read_text(path, kMaxListBytes));
  return std::optional(std::string(whole_rows(text)));
}

/// The frames of a take that is cut off: the fewest that a part of it has, and the times of those
/// that are known.
struct FrameCount {
  int fewest = std::numeric_limits<int>::max(), most = 0;
  std::vector<double> times_s;

  void add(int frames) { fewest = std::min(fewest, frames), most = std::max(most, frames); }
  double cut_s(double rate_hz) const {
    const auto at = [&](int frame) { return times_s[static_cast<std::size_t>(frame - 1)]; };
    if (fewest >= 1 && static_cast<int>(times_s.size()) >= most) return at(most) - at(fewest);
    return rate_hz > 0 ? (most - fewest) / rate_hz : 0;
  }
};

Result<void> count_tables(const Manifest& manifest, FrameCount& frames) {
  const fs::path& root = manifest.info.root;
  MIXRIG_ASSIGN(const auto ticks, rows_of(root / kTicksTable));
  if (ticks) {
    MIXRIG_ASSIGN(const auto rows, parse_ticks(*ticks, (root / kTicksTable).string()));
    for (const auto& [number, tick] : rows)
      frames.times_s.push_back(seconds(tick.mid_exposure.time_since_epoch()));
    frames.add(static_cast<int>(rows.size()));
  }
  if (manifest.pose_file.empty()) return {};
  MIXRIG_ASSIGN(const auto lines, rows_of(root / manifest.pose_file));
  MIXRIG_ASSIGN(const auto poses, parse_trajectory(lines.value_or(""), manifest.pose_file));
  if (frames.times_s.empty())
    for (const StampedPose& pose : poses) frames.times_s.push_back(pose.time_s);
  frames.add(static_cast<int>(poses.size()));
  return {};
}

/// Counts the pictures of the fisheye, which has its own rate.
Result<void> count_fisheye(TakeInfo& info) {
  if (!info.fisheye) return {};
  MIXRIG_ASSIGN(const int pictures, count_pictures(info.root, *info.fisheye));
  MIXRIG_ASSIGN(const auto rows, rows_of(info.root / kFisheyeTable));
  MIXRIG_ASSIGN(const auto stamps, parse_fisheye_table(rows.value_or(""), kFisheyeTable));
  info.fisheye->count = std::min(pictures, static_cast<int>(stamps.size()));
  if (info.fisheye->count == 0) info.fisheye.reset();
  return {};
}

std::vector<StreamInfo*> streams_of(TakeInfo& info) {
  std::vector<StreamInfo*> streams{&info.color, &info.depth};
  if (info.amplitude) streams.push_back(&*info.amplitude);
  if (info.depth2) streams.push_back(&info.depth2->depth);
  if (info.depth2 && info.depth2->amplitude) streams.push_back(&*info.depth2->amplitude);
  return streams;
}

Result<void> cut_table(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) return {};
  MIXRIG_ASSIGN(const std::string text, config::read_text(path, kMaxListBytes));
  const std::string_view whole = whole_rows(text);
  if (whole.size() == text.size()) return {};
  fs::resize_file(path, whole.size(), error);
  if (!error) return {};
  return system_error(ErrorCode::kIo, "cannot cut '" + path.string() + "'", error.value());
}

/// Cuts what is left of a picture behind the last whole one.
Result<void> cut_stream(const fs::path& path) {
  MIXRIG_ASSIGN(const MatroskaEnd end, find_matroska_end(path));
  std::error_code error;
  if (!fs::exists(path, error) ||
      static_cast<std::int64_t>(fs::file_size(path, error)) == end.bytes)
    return {};
  fs::resize_file(path, static_cast<std::uintmax_t>(end.bytes), error);
  if (!error) return {};
  return system_error(ErrorCode::kIo, "cannot cut '" + path.string() + "'", error.value());
}

}  // namespace

Result<WholePart> count_whole(Manifest& manifest) {
  TakeInfo& info = manifest.info;
  FrameCount frames;
  for (const StreamInfo* stream : streams_of(info)) {
    MIXRIG_ASSIGN(const int count, count_pictures(info.root, *stream));
    frames.add(count);
  }
  if (info.has_truth) {
    MIXRIG_ASSIGN(const int count,
                  count_files(info.root, manifest.truth_path + "/labels/%06d.png", 1));
    frames.add(count);
  }
  MIXRIG_TRY(count_tables(manifest, frames));
  MIXRIG_TRY(count_fisheye(info));
  if (frames.fewest < 1)
    return Error{ErrorCode::kData, "'" + info.root.string() +
                                       "' was cut off before its first frame was whole: there is "
                                       "nothing to read in it"};
  for (StreamInfo* stream : streams_of(info)) stream->count = frames.fewest;
  return WholePart{frames.fewest, frames.cut_s(info.color.rate_hz), FolderLock::is_held(info.root)};
}

std::string text_of(const WholePart& part, const std::string& name) {
  if (part.is_open)
    return fmt::format("'{}' is still being written: took {} frames so far", name, part.frames);
  return fmt::format("'{}': took {} frames, the last {:.1f} s were cut off", name, part.frames,
                     part.cut_s);
}

Result<WholePart> make_whole(const fs::path& folder) {
  const fs::path path = folder / "take.toml";
  MIXRIG_ASSIGN(const std::string text, config::read_text(path, kMostManifestText));
  MIXRIG_ASSIGN(Manifest manifest, parse_manifest(text, path));
  if (!manifest.unfinished) return WholePart{manifest.info.color.count, 0, false};
  MIXRIG_ASSIGN(const WholePart part, count_whole(manifest));
  TakeInfo& info = manifest.info;
  std::vector<StreamInfo*> streams = streams_of(info);
  if (info.fisheye) streams.push_back(&*info.fisheye);
  for (const StreamInfo* stream : streams)
    if (is_matroska(*stream)) MIXRIG_TRY(cut_stream(folder / stream->path));
  std::error_code error;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder, error))
    if (entry.path().extension() == ".csv") MIXRIG_TRY(cut_table(entry.path()));
  if (!manifest.pose_file.empty()) MIXRIG_TRY(cut_table(folder / manifest.pose_file));
  if (!info.calibration.empty()) info.calibration = info.calibration.filename();
  MIXRIG_TRY(write_file(path, manifest_text(info)));
  return part;
}

bool FolderLock::is_held(const fs::path& folder) {
  const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const bool held = fd >= 0 && ::flock(fd, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  if (fd >= 0) ::close(fd);
  return held;
}

FolderLock::FolderLock(const fs::path& folder)
    : fd_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (fd_ >= 0) holds_ = ::flock(fd_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
}

FolderLock::FolderLock(FolderLock&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)), holds_(other.holds_) {}

FolderLock& FolderLock::operator=(FolderLock&& other) noexcept {
  std::swap(fd_, other.fd_);
  std::swap(holds_, other.holds_);
  return *this;
}

FolderLock::~FolderLock() {
  if (fd_ >= 0) ::close(fd_);
}

}  // namespace mixrig::take

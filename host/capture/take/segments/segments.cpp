// SPDX-License-Identifier: Apache-2.0
#include "host/capture/take/segments/segments.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>

#include <fmt/format.h>

namespace mixrig::take {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kLeastDigits = 4, kMostDigits = 8;
constexpr std::string_view kPartialSuffix = ".partial";

/// The segment of a folder's name; nullopt for a name of another form.
std::optional<Segment> segment_of(const fs::path& path) {
  const std::string name = path.filename().string();
  std::string_view digits = name;
  Segment segment{0, path, digits.ends_with(kPartialSuffix)};
  if (segment.is_partial) digits.remove_suffix(kPartialSuffix.size());
  if (digits.size() < kLeastDigits || digits.size() > kMostDigits) return std::nullopt;
  const auto [end, error] =
      std::from_chars(digits.data(), digits.data() + digits.size(), segment.number);
  if (error != std::errc() || end != digits.data() + digits.size() || segment.number < 1)
    return std::nullopt;
  return segment;
}

}  // namespace

std::vector<Segment> segments_of(const fs::path& folder) {
  std::vector<Segment> segments;
  std::error_code error;
  if (fs::exists(folder / "take.toml", error)) return segments;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    std::error_code none;
    auto segment = segment_of(at->path());
    if (!segment || !at->is_directory(none)) continue;
    if (!segment->is_partial && !fs::exists(at->path() / "take.toml", none) &&
        !fs::is_empty(at->path(), none))
      continue;
    segments.push_back(*std::move(segment));
  }
  std::sort(segments.begin(), segments.end(), [](const Segment& a, const Segment& b) {
    return std::pair(a.number, a.is_partial) < std::pair(b.number, b.is_partial);
  });
  return segments;
}

Result<fs::path> next_segment(const fs::path& folder) {
  std::error_code error;
  const std::vector<Segment> segments = segments_of(folder);
  if (segments.empty() && fs::is_directory(folder, error) && !fs::is_empty(folder, error))
    return Error{ErrorCode::kUsage, "'" + folder.string() +
                                        "' holds other things than the takes of a recording in "
                                        "segments: give another folder"};
  fs::create_directories(folder, error);
  if (error)
    return system_error(ErrorCode::kIo, "cannot make folder '" + folder.string() + "'",
                        error.value());
  return folder / fmt::format("{:04}", segments.empty() ? 1 : segments.back().number + 1);
}

std::uint64_t bytes_below(const fs::path& folder) {
  std::error_code error;
  std::uint64_t bytes = 0;
  for (fs::recursive_directory_iterator at(folder, error), end; !error && at != end;
       at.increment(error)) {
    std::error_code none;
    const auto size = at->file_size(none);
    if (!none) bytes += size;
  }
  return bytes;
}

}  // namespace mixrig::take

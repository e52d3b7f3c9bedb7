// SPDX-License-Identifier: Apache-2.0
#include "host/operator/desk/take_list.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "hal/base/left_partial.h"
#include "hal/base/partial_path.h"
#include "host/math/config/table.h"
#include "host/math/config/toml_lines.h"

namespace mixrig::session {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostTakes = 1000, kMostNoteBytes = std::size_t{64} << 10;
constexpr std::string_view kPartial = ".partial";
constexpr double kLeastTold_s = 2;  ///< a shorter recording says little about its bytes a second

double megabytes_of(const fs::path& folder) {
  std::error_code code;
  double bytes = 0;
  for (fs::recursive_directory_iterator at(folder, code), end; !code && at != end;
       at.increment(code)) {
    std::error_code none;
    const auto size = fs::file_size(at->path(), none);
    if (!none) bytes += static_cast<double>(size);
  }
  return bytes / 1e6;
}

/// What recording.toml says. Keys that a later version adds are ignored.
page::TakeState take_of(const fs::path& folder) {
  page::TakeState take;
  take.name = folder.filename().string();
  take.megabytes = megabytes_of(folder);
  take.state = "cut off";
  auto document = config::Document::read(folder / "recording.toml");
  if (!document) return take;
  const config::Table root = document->root();
  take.notes = root.text_or("notes", "");
  take.circled = root.boolean_or("circled", false);
  take.frames = static_cast<std::uint64_t>(root.number_or("frames", 0, config::kNotNegative));
  take.lost = static_cast<std::uint64_t>(root.number_or("lost", 0, config::kNotNegative));
  take.seconds = root.number_or("seconds", 0, config::kNotNegative);
  const std::string ended = root.text_or("ended", "stopped");
  take.state = ended == "stopped" ? "whole" : ended;
  return take;
}

}  // namespace

/// Precondition: mutex_ is held.
void TakeList::look() const {
  std::error_code code;
  const auto stamp = fs::last_write_time(folder_, code);
  if (!code && stamp == looked_) return;
  looked_ = code ? fs::file_time_type{} : stamp;
  takes_.clear();
  std::vector<std::pair<fs::file_time_type, page::TakeState>> found;
  for (fs::directory_iterator at(folder_, code), end; !code && at != end; at.increment(code)) {
    std::error_code none;
    const fs::path folder = at->path();
    const bool is_partial = folder.filename().string().ends_with(kPartial);
    if (found.size() >= kMostTakes || !fs::is_directory(folder, none)) continue;
    if (!is_partial && !fs::exists(folder / "recording.toml", none)) continue;
    auto began = fs::last_write_time(folder / "composite", none);
    if (none) began = fs::last_write_time(folder, none);
    found.emplace_back(began, take_of(folder));
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (auto& [began, take] : found) takes_.push_back(std::move(take));
}

std::vector<page::TakeState> TakeList::takes(const page::RecordingState& running) const {
  const std::lock_guard lock(mutex_);
  look();
  std::vector<page::TakeState> takes = takes_;
  if (running.on) {
    const std::string partial = partial_of(folder_ / running.name).filename().string();
    std::erase_if(takes, [&](const page::TakeState& take) { return take.name == partial; });
  }
  return takes;
}

std::optional<double> TakeList::minutes_left(const page::RecordingState& running,
                                             std::optional<double> free_gb) const {
  if (!free_gb) return std::nullopt;
  double seconds = 0, megabytes = 0;
  if (running.on && running.seconds >= kLeastTold_s) {
    seconds = running.seconds;
    megabytes = megabytes_of(partial_of(folder_ / running.name));
  } else {
    const std::lock_guard lock(mutex_);
    look();
    for (const page::TakeState& take : takes_)
      if (take.seconds >= kLeastTold_s) seconds = take.seconds, megabytes = take.megabytes;
  }
  if (!(seconds > 0) || !(megabytes > 0)) return std::nullopt;
  return *free_gb * 1e3 / (megabytes / seconds) / 60;
}

Result<void> TakeList::apply(const page::SetTake& set) {
  const fs::path file = folder_ / set.name / "recording.toml";
  const auto text = config::read_text(file, kMostNoteBytes);
  if (!text) return Error{ErrorCode::kNotFound, "there is no whole recording \"" + set.name + "\""};
  config::Lines lines = config::lines_of(*text);
  lines.insert(lines.begin(), "");  // in place of a table's header
  config::Block root{0, lines.size()};
  if (set.circled)
    config::set_line_in(lines, root, "circled", config::value_line("circled", *set.circled));
  if (set.notes)
    config::set_line_in(lines, root, "notes",
                        config::value_line("notes", std::string_view(*set.notes)));
  lines.erase(lines.begin());
  const std::string edited = config::text_of_lines(lines);
  const auto check = config::Document::parse(edited, file.string());
  if (!check)
    return Error{ErrorCode::kFormat, file.string() + " cannot be changed: write it by hand"};
  const std::lock_guard lock(mutex_);
  looked_ = {};
  return write_file(file, edited);
}

Result<Image<Rgb8>> TakeList::picture(const std::string& name, int frame) {
  const Error none{ErrorCode::kNotFound, "there is no whole recording \"" + name + "\""};
  std::error_code code;
  if (!fs::exists(folder_ / name / "recording.toml", code)) return none;
  if (!player_ || played_ != name) {
    MIXRIG_ASSIGN(player_, take::TakeReader::open(folder_ / name / "composite"));
    played_ = name;
  }
  const int frames = player_->info().frames;
  if (frame < 1 || frame > frames)
    return Error{ErrorCode::kNotFound, "\"" + name + "\" has frames 1 to " +
                                           std::to_string(frames) + ", not " +
                                           std::to_string(frame)};
  capture::Capture read;
  MIXRIG_TRY(player_->read(frame, read));
  return std::move(read.plate);
}

}  // namespace mixrig::session

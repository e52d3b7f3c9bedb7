// SPDX-License-Identifier: Apache-2.0
// Reads and writes take.toml as TakeInfo. Private to this module.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host/capture/take/take.h"

namespace mixrig::take {

/// Content of take.toml; the reader of the streams sets `info.frames`.
struct Manifest {
  TakeInfo info;
  std::string pose_file;                     ///< empty where there is none
  std::optional<geometry::Pose> fixed_pose;  ///< world_from_target of a static camera
  std::string truth_path;                    ///< empty where there is none
  /// Steps of depth and depth2 that mean no measurement beside the first one, which `info` has.
  std::vector<int> further_unknown, further_unknown2;
  /// It was saved while the take was being written: its counts are not those of the files.
  bool unfinished = false;
  bool without_tables = false;  ///< a folder without take.toml; its camera is assumed, or that of
                                ///< info.file
};

/// Whether the stream is a list "stamp file" of a TUM folder, not numbered pictures.
bool is_list(const StreamInfo& stream);
bool is_matroska(const StreamInfo& stream);

/// Parses the text of a manifest; `path` is its path. Pure but for the environment.
/// Errors: kFormat (file:line: key ...).
Result<Manifest> parse_manifest(std::string_view text, const std::filesystem::path& path);

/// Returns the manifest as text, its streams below root ".". `unfinished`: more frames follow;
/// `further_unknown`: depth steps without a measurement beside info.depth_unknown, at most three.
std::string manifest_text(const TakeInfo& info, bool unfinished = false,
                          std::span<const int> further_unknown = {});

}  // namespace mixrig::take

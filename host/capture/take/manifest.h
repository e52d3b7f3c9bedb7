// SPDX-License-Identifier: Apache-2.0
// take.toml to and from TakeInfo. Private to this module.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/capture/take/take.h"

namespace mixrig::take {

/// What take.toml says; `info.frames` is set by the reader of the streams.
struct Manifest {
  TakeInfo info;
  std::string pose_file;                     ///< empty where there is none
  std::optional<geometry::Pose> fixed_pose;  ///< world_from_target of a static camera
  std::string truth_path;                    ///< empty where there is none
  /// Steps of depth and depth2 that mean no measurement beside the first one, which `info` has.
  std::vector<int> further_unknown, further_unknown2;
  bool without_tables = false;  ///< a folder without take.toml; its camera is assumed, or that of
                                ///< info.file
};

/// A list "stamp file" of a TUM folder in place of numbered pictures.
bool is_list(const StreamInfo& stream);
bool is_matroska(const StreamInfo& stream);

/// Parses the text of a manifest; `path` is where it lies. Pure but for the environment.
/// Errors: kFormat (file:line: key ...).
Result<Manifest> parse_manifest(std::string_view text, const std::filesystem::path& path);

/// The manifest as text, its streams below root ".".
std::string manifest_text(const TakeInfo& info);

}  // namespace mixrig::take

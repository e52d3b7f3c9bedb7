// SPDX-License-Identifier: Apache-2.0
// The plates of a sweep at other exposures: bracket.csv and bracket/%06d.png beside take.toml.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/image.h"
#include "hal/base/result.h"

namespace mixrig::take {

inline constexpr const char* kBracketTable = "bracket.csv";
inline constexpr const char* kBracketHeader = "picture,frame,exposure_s,frames_exposure_s\n";

/// A row of bracket.csv. Row k (from 0) describes picture k + 1.
struct BracketRow {
  int frame = 0;                        ///< number in the take of the view's last frame, from 1
  double exposure_s = 0, frames_s = 0;  ///< exposure of the picture, and of the view's frames
  bool operator==(const BracketRow&) const = default;
};

/// Parses the rows after a header line; pictures count from 1, frames do not fall, exposures are
/// 1e-7 to 1000 s. Pure. Errors: kFormat (name:line: ...).
Result<std::vector<BracketRow>> parse_bracket_table(std::string_view text, const std::string& name);
std::string bracket_text(const std::vector<BracketRow>& rows);

/// Reads the rows of the take in `folder`; none if it has no bracket.csv. Errors: kFormat, kIo.
Result<std::vector<BracketRow>> read_bracket_table(const std::filesystem::path& folder);
/// Reads picture `number` (from 1). Errors: those of image_io::read_rgb8.
Result<void> read_bracket_plate(const std::filesystem::path& folder, int number,
                                Image<Rgb8>& plate);
/// Writes picture `number`; makes the folder if it is missing. Errors: kIo.
Result<void> write_bracket_plate(const std::filesystem::path& folder, int number,
                                 ImageView<const Rgb8> plate);

}  // namespace mixrig::take

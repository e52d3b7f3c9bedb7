// SPDX-License-Identifier: Apache-2.0
// Words of --source studio:..., separated by commas. Private to this module.
#pragma once

#include <charconv>
#include <string>
#include <vector>

#include "hal/base/image.h"
#include "hal/base/result.h"

namespace mixrig::studio_io {

/// Splits text at its commas into exactly `most` words; those left out are empty. `forms`: the
/// expected form, for the error. Errors: kUsage for more words.
Result<std::vector<std::string>> split_words(const std::string& words, std::size_t most,
                                             const char* forms);

/// Reads a whole number into `value`, which stays where `word` is empty. Errors: kUsage.
template <typename Int>
Result<void> read_number(const std::string& word, const char* what, Int& value) {
  if (word.empty()) return {};
  const char* end = word.data() + word.size();
  const auto parsed = std::from_chars(word.data(), end, value);
  if (parsed.ec == std::errc{} && parsed.ptr == end) return {};
  return Error{ErrorCode::kUsage,
               "--source studio: " + std::string(what) + " \"" + word + "\" is not a whole number"};
}

/// Reads WxH into `size`, which stays where `word` is empty. Errors: kUsage.
Result<void> read_size(const std::string& word, Size& size);

}  // namespace mixrig::studio_io

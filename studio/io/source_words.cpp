// SPDX-License-Identifier: Apache-2.0
#include "studio/io/source_words.h"

namespace mixrig::studio_io {

Result<std::vector<std::string>> split_words(const std::string& words, std::size_t most,
                                             const char* forms) {
  std::vector<std::string> out(1);
  for (const char c : words) {
    if (c == ',')
      out.emplace_back();
    else
      out.back() += c;
  }
  if (out.size() > most)
    return Error{ErrorCode::kUsage,
                 "--source studio:" + words + ": give at most " + std::string(forms)};
  out.resize(most);
  return out;
}

Result<void> read_size(const std::string& word, Size& size) {
  if (word.empty()) return {};
  const std::size_t x = word.find('x');
  if (x == std::string::npos)
    return Error{ErrorCode::kUsage, "--source studio: size \"" + word + "\": give WxH"};
  MIXRIG_TRY(read_number(word.substr(0, x), "width", size.width));
  return read_number(word.substr(x + 1), "height", size.height);
}

}  // namespace mixrig::studio_io

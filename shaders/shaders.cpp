// SPDX-License-Identifier: Apache-2.0
#include "shaders/shaders.h"

#include <algorithm>
#include <cctype>

namespace mixrig::shaders {
namespace {

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

std::size_t digits_end(std::string_view text, std::size_t at) {
  while (at < text.size() && is_digit(text[at])) ++at;
  return at;
}

}  // namespace

const Stage* find_stage(std::string_view name) {
  const auto& stages = all_stages();
  const auto found = std::find_if(stages.begin(), stages.end(),
                                  [&](const Stage& stage) { return stage.name == name; });
  return found == stages.end() ? nullptr : &*found;
}

std::string name_files(std::string_view log, const std::vector<std::string_view>& files) {
  std::string out;
  for (std::size_t at = 0; at < log.size();) {
    const bool starts_number = is_digit(log[at]) && (at == 0 || !std::isalnum(log[at - 1]));
    const std::size_t end = starts_number ? digits_end(log, at) : at;
    const bool line_follows = end > at && end - at <= 3 && end + 1 < log.size() &&
                              (log[end] == ':' || log[end] == '(') && is_digit(log[end + 1]);
    const auto number = line_follows ? std::stoul(std::string(log.substr(at, end - at))) : 0;
    if (!line_follows || number >= files.size()) {
      out += log[at++];
      continue;
    }
    const std::size_t line_end = digits_end(log, end + 1);
    out.append(files[number]).append(":").append(log.substr(end + 1, line_end - end - 1));
    at = line_end;
  }
  return out;
}

}  // namespace mixrig::shaders

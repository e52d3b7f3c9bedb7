// SPDX-License-Identifier: Apache-2.0
#include "host/operator/page/json_body.h"

#include <fmt/format.h>

#include "host/operator/page/route.h"

namespace mixrig::page {
namespace {

/// Length of the sequence that starts with this byte, 0 for none.
int utf8_length(unsigned char c) {
  if (c < 0x80) return 1;
  if (c >= 0xC2 && c < 0xE0) return 2;
  if (c >= 0xE0 && c < 0xF0) return 3;
  return c >= 0xF0 && c < 0xF5 ? 4 : 0;
}

/// Whether JSON is at most kMostDepth deep, by its brackets: nlohmann::json recurses to destroy it.
bool is_shallow(std::string_view text) {
  constexpr int kMostDepth = 8;
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted && c == '\\')
      ++i;
    else if (c == '"')
      quoted = !quoted;
    else if (!quoted && (c == '{' || c == '[') && ++depth > kMostDepth)
      return false;
    else if (!quoted && (c == '}' || c == ']'))
      --depth;
  }
  return true;
}

}  // namespace

bool is_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const int length = utf8_length(static_cast<unsigned char>(text[i]));
    if (length == 0 || i + static_cast<std::size_t>(length) > text.size()) return false;
    for (int k = 1; k < length; ++k)
      if ((static_cast<unsigned char>(text[i + static_cast<std::size_t>(k)]) & 0xC0) != 0x80)
        return false;
    i += static_cast<std::size_t>(length);
  }
  return true;
}

std::string to_text(const nlohmann::json& json) {
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

Result<nlohmann::json> parse_json(std::string_view text) {
  if (!is_shallow(text)) return Error{ErrorCode::kUsage, "the body is too deep: at most 8 levels"};
  auto json = nlohmann::json::parse(text, nullptr, false);
  if (json.is_discarded()) return Error{ErrorCode::kUsage, "the body is no JSON"};
  return json;
}

Result<Body> Body::parse(std::string_view text) {
  Body body;
  body.json_ = nlohmann::json::object();
  if (text.empty()) return body;
  MIXRIG_ASSIGN(body.json_, parse_json(text));
  if (!body.json_.is_object()) return Error{ErrorCode::kUsage, "the body is no JSON object"};
  return body;
}

const nlohmann::json* Body::find(const char* key) const {
  known_.insert(key);
  const auto found = json_.find(key);
  return found == json_.end() ? nullptr : &*found;
}

void Body::fail(const std::string& key, const std::string& what) const {
  if (!fault_) fault_ = Error{ErrorCode::kUsage, key + " " + what};
}

std::optional<Error> Body::first_fault() const {
  if (fault_) return fault_;
  for (const auto& [key, value] : json_.items())
    if (!known_.contains(key))
      return Error{ErrorCode::kUsage, key.substr(0, 64) + " is not known here: remove it"};
  return std::nullopt;
}

std::string Body::range_text(int count, double least, double most) {
  return count == 1
             ? fmt::format("is a number from {:g} to {:g}", least, most)
             : fmt::format("is an array of {} numbers from {:g} to {:g}", count, least, most);
}

std::optional<double> Body::number(const char* key, double least, double most) const {
  const nlohmann::json* value = find(key);
  if (value == nullptr) return std::nullopt;
  const double number = value->is_number() ? value->get<double>() : least - 1;
  if (number >= least && number <= most) return number;
  fail(key, range_text(1, least, most));
  return std::nullopt;
}

std::optional<bool> Body::boolean(const char* key) const {
  const nlohmann::json* value = find(key);
  if (value == nullptr) return std::nullopt;
  if (value->is_boolean()) return value->get<bool>();
  fail(key, "is true or false");
  return std::nullopt;
}

std::optional<std::string> Body::text(const char* key, std::size_t most_bytes) const {
  const nlohmann::json* value = find(key);
  if (value == nullptr) return std::nullopt;
  if (value->is_string() && value->get_ref<const std::string&>().size() <= most_bytes)
    return value->get<std::string>();
  fail(key, fmt::format("is a text of at most {} bytes", most_bytes));
  return std::nullopt;
}

std::optional<std::string> Body::name(const char* key) const {
  auto value = text(key, kMostName);
  if (!value || is_name(*value)) return value;
  fail(key, "is a name of 1 to 64 bytes without control characters");
  return std::nullopt;
}

}  // namespace mixrig::page

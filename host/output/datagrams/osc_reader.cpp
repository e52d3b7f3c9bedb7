// SPDX-License-Identifier: Apache-2.0
// OSC 1.0, "OSC Syntax": numbers are big-endian, everything is filled up to a multiple of 4 bytes.
#include "host/output/datagrams/osc_reader.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <string_view>

namespace mixrig::stream {
namespace {

constexpr std::size_t kMostMessages = 32, kMostArguments = 16;
constexpr int kMostDepth = 4;
constexpr std::string_view kBundle = "#bundle";

Error bad_osc(const char* what) { return {ErrorCode::kFormat, std::string("OSC: ") + what}; }

class OscCursor {
 public:
  explicit OscCursor(std::span<const std::uint8_t> bytes) : rest_(bytes) {}
  bool at_end() const { return rest_.empty(); }

  std::optional<std::uint64_t> word(std::size_t bytes) {
    if (rest_.size() < bytes) return std::nullopt;
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < bytes; ++i) value = value << 8 | rest_[i];
    rest_ = rest_.subspan(bytes);
    return value;
  }
  std::optional<std::span<const std::uint8_t>> take(std::size_t bytes) {
    if (rest_.size() < bytes) return std::nullopt;
    const auto taken = rest_.first(bytes);
    rest_ = rest_.subspan(bytes);
    return taken;
  }
  /// Takes a text up to its zero byte, and its padding.
  std::optional<std::string> text() {
    const auto end = std::find(rest_.begin(), rest_.end(), 0);
    if (end == rest_.end()) return std::nullopt;
    const auto length = static_cast<std::size_t>(end - rest_.begin());
    std::string text(rest_.begin(), end);
    if (!take(length / 4 * 4 + 4)) return std::nullopt;
    return text;
  }

 private:
  std::span<const std::uint8_t> rest_;
};

/// True where a value was read or the type has none.
bool read_argument(char type, OscCursor& cursor, std::vector<OscArgument>& out) {
  const auto number = [&](std::size_t bytes, auto&& of_word) {
    const auto word = cursor.word(bytes);
    if (word) out.emplace_back(static_cast<double>(of_word(*word)));
    return word.has_value();
  };
  switch (type) {
    case 'i':
      return number(4, [](std::uint64_t w) { return static_cast<std::int32_t>(w); });
    case 'h':
      return number(8, [](std::uint64_t w) { return static_cast<std::int64_t>(w); });
    case 'f':
      return number(
          4, [](std::uint64_t w) { return std::bit_cast<float>(static_cast<std::uint32_t>(w)); });
    case 'd':
      return number(8, [](std::uint64_t w) { return std::bit_cast<double>(w); });
    case 's': {
      auto text = cursor.text();
      if (text) out.emplace_back(*std::move(text));
      return text.has_value();
    }
    case 'T':
    case 'F':
      out.emplace_back(type == 'T');
      return true;
    case 'N':
    case 'I':
      return true;
    default:
      return false;
  }
}

Result<void> read_message(OscCursor cursor, std::vector<OscReceived>& out) {
  if (out.size() >= kMostMessages) return bad_osc("more than 32 messages in a bundle");
  auto address = cursor.text();
  if (!address || address->empty() || address->front() != '/') return bad_osc("no address");
  OscReceived& message = out.emplace_back();
  message.address = *std::move(address);
  if (cursor.at_end()) return {};  // of old senders
  const auto types = cursor.text();
  if (!types || types->empty() || types->front() != ',')
    return bad_osc("no types of its arguments");
  if (types->size() > kMostArguments + 1) return bad_osc("more than 16 arguments");
  for (const char type : types->substr(1))
    if (!read_argument(type, cursor, message.arguments))
      return bad_osc("an argument is cut off, or of a type that is not known");
  for (const OscArgument& argument : message.arguments)
    if (const double* number = std::get_if<double>(&argument); number && !std::isfinite(*number))
      return bad_osc("a number is not finite");
  return {};
}

Result<void> read_element(std::span<const std::uint8_t> bytes, int depth,
                          std::vector<OscReceived>& out) {
  OscCursor cursor(bytes);
  if (bytes.size() % 4 != 0) return bad_osc("its size is no multiple of 4");
  if (bytes.size() < 16 || std::memcmp(bytes.data(), kBundle.data(), kBundle.size() + 1) != 0)
    return read_message(cursor, out);
  if (depth >= kMostDepth) return bad_osc("bundles within bundles within bundles");
  (void)cursor.take(16);  // with the time tag
  while (!cursor.at_end()) {
    const auto size = cursor.word(4);
    const auto element = size ? cursor.take(*size) : std::nullopt;
    if (!element) return bad_osc("a bundle is cut off");
    MIXRIG_TRY(read_element(*element, depth + 1, out));
  }
  return {};
}

}  // namespace

Result<std::vector<OscReceived>> parse_osc(std::span<const std::uint8_t> datagram) {
  std::vector<OscReceived> messages;
  MIXRIG_TRY(read_element(datagram, 0, messages));
  return messages;
}

}  // namespace mixrig::stream

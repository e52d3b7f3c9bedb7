// SPDX-License-Identifier: Apache-2.0
// OSC 1.0, "OSC Syntax": numbers are big-endian, everything is filled up to a multiple of 4 bytes.
#include "host/output/datagrams/osc.h"

#include <bit>

namespace mixrig::stream {
namespace {

void put_word(std::uint32_t word, std::string& out) {
  for (const int shift : {24, 16, 8, 0}) out.push_back(static_cast<char>(word >> shift & 0xFF));
}

/// Appends a text with at least one zero byte at its end.
void put_text(std::string_view text, std::string& out) {
  text = text.substr(0, text.find('\0'));
  out += text;
  out.append(4 - text.size() % 4, '\0');
}

}  // namespace

OscMessage& OscMessage::add(std::int32_t value) {
  types_ += 'i';
  put_word(static_cast<std::uint32_t>(value), arguments_);
  return *this;
}

OscMessage& OscMessage::add(float value) {
  types_ += 'f';
  put_word(std::bit_cast<std::uint32_t>(value), arguments_);
  return *this;
}

OscMessage& OscMessage::add(std::string_view text) {
  types_ += 's';
  put_text(text, arguments_);
  return *this;
}

std::string OscMessage::bytes() const {
  std::string out;
  put_text(address_, out);
  put_text(types_, out);
  return out + arguments_;
}

std::string osc_name(std::string_view text) {
  constexpr std::string_view kForbidden = " #*,/?[]{}";
  std::string name(text.empty() ? "_" : text);
  for (char& c : name)
    if (c < '!' || c > '~' || kForbidden.find(c) != std::string_view::npos) c = '_';
  return name;
}

}  // namespace mixrig::stream

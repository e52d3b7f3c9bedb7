// SPDX-License-Identifier: Apache-2.0
// Writes messages of Open Sound Control 1.0 for show control, one a datagram. osc_reader.h reads
// them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace mixrig::stream {

/// An address and arguments, without a time tag: it takes effect at once.
class OscMessage {
 public:
  /// Precondition: parts of the address are made by osc_name().
  explicit OscMessage(std::string_view address) : address_(address) {}
  OscMessage& add(std::int32_t value);
  OscMessage& add(float value);
  /// Adds the text up to its first zero byte. Bytes that are not ASCII are sent unchanged.
  OscMessage& add(std::string_view text);
  /// Returns the datagram.
  std::string bytes() const;

 private:
  std::string address_, types_ = ",", arguments_;
};

/// Makes a text a part of an address: characters that OSC forbids there, or that are not ASCII,
/// become "_"; an empty text is "_".
std::string osc_name(std::string_view text);

}  // namespace mixrig::stream

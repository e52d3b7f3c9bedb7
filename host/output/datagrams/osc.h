// SPDX-License-Identifier: Apache-2.0
// Open Sound Control 1.0: messages for show control, one in a datagram. Written here; osc_reader.h
// reads them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace mixrig::stream {

/// An address and arguments. Without a time tag: it is of now.
class OscMessage {
 public:
  /// Precondition: parts of the address are names by osc_name().
  explicit OscMessage(std::string_view address) : address_(address) {}
  OscMessage& add(std::int32_t value);
  OscMessage& add(float value);
  /// Up to its first zero byte. Not ASCII is sent as it is.
  OscMessage& add(std::string_view text);
  /// The datagram.
  std::string bytes() const;

 private:
  std::string address_, types_ = ",", arguments_;
};

/// A text as part of an address: what OSC forbids there is "_", so is what is not ASCII; "_" for no
/// text.
std::string osc_name(std::string_view text);

}  // namespace mixrig::stream

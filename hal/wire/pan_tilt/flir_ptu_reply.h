// SPDX-License-Identifier: Apache-2.0
// Replies of FLIR / Directed Perception pan-tilt units (ASCII protocol), parsed by pure functions.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace mixrig::device {

enum class PtuAxis { kNone, kPan, kTilt };

/// One reply: "* text" or "! text".
struct PtuReply {
  bool ok = false;
  bool interrupted = false;  ///< a limit report came between its bytes: do not trust the text
  bool too_long = false;     ///< longer than any reply of the protocol; text is cut
  std::array<char, 96> text{};
  std::size_t size = 0;
  std::string_view view() const { return {text.data(), size}; }
};

/// Splits the byte stream into echo, replies, and the limit reports "!P" and "!T", which the unit
/// sends at any time, also in the middle of a reply. Never allocates; accepts any bytes.
class PtuReplyParser {
 public:
  /// Sets the command sent last, so that its echo is not counted as noise. Drops a partial reply.
  void expect(std::string_view command);
  /// Parses one byte; returns a reply when the byte ended one.
  std::optional<PtuReply> feed(char byte);

  std::uint64_t pan_limits() const { return pan_limits_; }
  std::uint64_t tilt_limits() const { return tilt_limits_; }
  std::uint64_t noise_bytes() const { return noise_; }

 private:
  std::optional<PtuReply> feed_text(char byte);
  void begin(bool ok);
  void append(char byte);
  void count_noise(char byte);
  bool take_limit(char axis);

  std::array<char, 64> echo_{};
  std::size_t echo_size_ = 0, echo_at_ = 0;
  PtuReply reply_;
  bool in_reply_ = false;
  bool bang_ = false;  ///< the last byte was '!': the next one decides
  std::uint64_t pan_limits_ = 0, tilt_limits_ = 0, noise_ = 0;
};

/// Returns the only number in a reply's text, e.g. "Current Pan position is -12"; empty when there
/// is none, more than one, or a malformed one.
std::optional<double> ptu_number(std::string_view text);
/// Returns the axis that a verbose reply names; kNone in terse mode.
PtuAxis ptu_axis(std::string_view text);

}  // namespace mixrig::device

// SPDX-License-Identifier: Apache-2.0
#include "hal/wire/pan_tilt/flir_ptu_reply.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace mixrig::device {
namespace {

bool is_end(char byte) { return byte == '\r' || byte == '\n'; }
bool in_number(char byte) {
  return (byte >= '0' && byte <= '9') || byte == '-' || byte == '+' || byte == '.';
}

}  // namespace

void PtuReplyParser::expect(std::string_view command) {
  echo_size_ = std::min(command.size(), echo_.size());
  std::copy_n(command.data(), echo_size_, echo_.data());
  echo_at_ = 0;
  in_reply_ = false;  // but a limit report may have begun: bang_ is kept
}

std::optional<PtuReply> PtuReplyParser::feed(char byte) {
  if (!bang_) {
    if (byte == '!') {
      bang_ = true;
      return std::nullopt;
    }
    return feed_text(byte);
  }
  bang_ = false;
  if (take_limit(byte)) return std::nullopt;
  if (in_reply_) noise_ += reply_.size + 1;  // the first reply never ended: it is lost
  begin(false);
  if (byte == '!') {
    bang_ = true;
    return std::nullopt;
  }
  return feed_text(byte);
}

bool PtuReplyParser::take_limit(char axis) {
  if (axis != 'P' && axis != 'T') return false;
  ++(axis == 'P' ? pan_limits_ : tilt_limits_);
  reply_.interrupted = reply_.interrupted || in_reply_;
  return true;
}

std::optional<PtuReply> PtuReplyParser::feed_text(char byte) {
  if (byte == '*') {
    if (in_reply_) noise_ += reply_.size + 1;
    begin(true);
    return std::nullopt;
  }
  if (!in_reply_) {
    count_noise(byte);
    return std::nullopt;
  }
  if (!is_end(byte)) {
    append(byte);
    return std::nullopt;
  }
  in_reply_ = false;
  return reply_;
}

void PtuReplyParser::begin(bool ok) {
  reply_ = PtuReply{};
  reply_.ok = ok;
  in_reply_ = true;
}

void PtuReplyParser::append(char byte) {
  if (reply_.size == 0 && byte == ' ') return;
  if (reply_.size == reply_.text.size()) {
    reply_.too_long = true;
    return;
  }
  reply_.text[reply_.size++] = byte;
}

void PtuReplyParser::count_noise(char byte) {
  if (echo_at_ < echo_size_ && byte == echo_[echo_at_]) {
    ++echo_at_;
    return;
  }
  if (!is_end(byte) && byte != ' ') ++noise_;
}

std::optional<double> ptu_number(std::string_view text) {
  std::optional<double> found;
  for (std::size_t at = 0; at < text.size();) {
    if (!in_number(text[at])) {
      ++at;
      continue;
    }
    const std::size_t end = static_cast<std::size_t>(
        std::find_if_not(text.begin() + at, text.end(), in_number) - text.begin());
    const bool plus = text[at] == '+';
    if (plus && at + 1 < end && text[at + 1] == '-') return std::nullopt;
    const char* first = text.data() + at + (plus ? 1 : 0);
    const char* last = text.data() + end;
    double value = 0;
    const auto [stop, fault] = std::from_chars(first, last, value, std::chars_format::fixed);
    if (fault != std::errc() || stop != last || found || !std::isfinite(value)) return std::nullopt;
    const bool glued = (at > 0 && text[at - 1] != ' ') || (end < text.size() && text[end] != ' ');
    if (glued) return std::nullopt;
    found = value;
    at = end;
  }
  return found;
}

PtuAxis ptu_axis(std::string_view text) {
  const bool pan = text.find("Pan") != std::string_view::npos;
  const bool tilt = text.find("Tilt") != std::string_view::npos;
  if (pan == tilt) return PtuAxis::kNone;
  return pan ? PtuAxis::kPan : PtuAxis::kTilt;
}

}  // namespace mixrig::device

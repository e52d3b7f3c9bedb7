// SPDX-License-Identifier: Apache-2.0
#include "hal/fake/flir_ptu_emulator.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

namespace mixrig::fake {
namespace {

constexpr std::array<const char*, 2> kAxisNames = {"Pan", "Tilt"};
constexpr std::size_t kLongestCommand = 64;

bool parse(std::string_view text, long& value) {
  const auto [stop, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  return fault == std::errc() && stop == text.data() + text.size();
}

}  // namespace

void FlirPtuEmulator::receive(std::span<const std::uint8_t> bytes, HostTime now) {
  for (const std::uint8_t byte : bytes) {
    if (echo_) output_ += static_cast<char>(byte);
    if (byte != ' ' && byte != '\r') {
      if (command_.size() < kLongestCommand) command_ += static_cast<char>(byte);
      continue;
    }
    output_ += held_;
    held_.clear();
    if (!command_.empty()) run(command_, now);
    command_.clear();
  }
}

std::array<long, 2> FlirPtuEmulator::position(HostTime now) {
  move(now);
  return {std::lround(axes_[0].position), std::lround(axes_[1].position)};
}

void FlirPtuEmulator::move(HostTime now) {
  if (now <= moved_) return;  // callers on several threads read the clock before they take turns
  const double passed_s = seconds(now - moved_);
  moved_ = now;
  if (faults.stalled) return;
  for (Axis& axis : axes_) {
    const double way = static_cast<double>(axis.target) - axis.position;
    axis.position += std::clamp(way, -axis.speed * passed_s, axis.speed * passed_s);
  }
}

void FlirPtuEmulator::run(std::string_view command, HostTime now) {
  ++commands_;
  move(now);
  if (command == "ED" || command == "EE") {
    echo_ = command == "EE";
    return answer("*");
  }
  if (command == "FV" || command == "FT") {
    verbose_ = command == "FV";
    return answer("*");
  }
  if (command == "CI" || command == "CV" || command == "I" || command == "S" || command == "A")
    return answer("*");
  if (command == "V") return answer("* Pan-Tilt Controller v2.14.0, emulated");
  if (command == "H") {
    for (Axis& axis : axes_) axis.target = std::lround(axis.position);
    return answer("*");
  }
  if (command.size() >= 2 && (command[0] == 'P' || command[0] == 'T'))
    return on_axis(command[0] == 'P' ? 0 : 1, command[1], command.substr(2));
  answer("! Illegal command");
}

void FlirPtuEmulator::on_axis(int index, char what, std::string_view value) {
  const Axis& axis = axes_[static_cast<std::size_t>(index)];
  const std::string name = kAxisNames[static_cast<std::size_t>(index)];
  switch (what) {
    case 'P':
      return on_position(index, value);
    case 'S':
    case 'A':
      return on_setting(index, what, value);
    case 'R': {
      const std::string number = fmt::format("{:.4f}", axis.arcsec);
      return answer_number(number + " seconds arc per " + name + " position", number);
    }
    case 'N':
    case 'X': {
      const std::string limit = std::to_string(what == 'N' ? axis.minimum : axis.maximum);
      return answer_number(
          std::string(what == 'N' ? "Minimum " : "Maximum ") + name + " position is " + limit,
          limit);
    }
    default:
      answer("! Illegal command");
  }
}

void FlirPtuEmulator::on_position(int index, std::string_view value) {
  Axis& axis = axes_[static_cast<std::size_t>(index)];
  const std::string name = kAxisNames[static_cast<std::size_t>(index)];
  const std::string now = std::to_string(std::lround(axis.position));
  long target = 0;
  if (value.empty()) return answer_number("Current " + name + " position is " + now, now);
  if (!parse(value, target)) return answer("! Illegal argument");
  if (target < axis.minimum || target > axis.maximum)
    return answer(
        target < axis.minimum
            ? "! Minimum allowable " + name + " position is " + std::to_string(axis.minimum)
            : "! Maximum allowable " + name + " position is " + std::to_string(axis.maximum));
  axis.target = target;
  answer("*");
}

void FlirPtuEmulator::on_setting(int index, char what, std::string_view value) {
  Axis& axis = axes_[static_cast<std::size_t>(index)];
  double& setting = what == 'S' ? axis.speed : axis.acceleration;
  long wanted = 0;
  if (value.empty()) {
    const std::string now = std::to_string(std::lround(setting));
    return answer_number(std::string("Current ") + kAxisNames[static_cast<std::size_t>(index)] +
                             " setting is " + now,
                         now);
  }
  if (!parse(value, wanted) || wanted < 1 || wanted > 100000) return answer("! Illegal argument");
  setting = static_cast<double>(wanted);
  answer("*");
}

void FlirPtuEmulator::answer_number(std::string_view verbose, std::string_view terse) {
  answer("* " + std::string(verbose_ ? verbose : terse));
}

void FlirPtuEmulator::answer(std::string_view text) {
  if (faults.silent) return;
  std::string line = with_faults(std::string(text) + "\r\n");
  if (faults.late_replies > 0) {
    --faults.late_replies;
    held_ += line;
    return;
  }
  output_ += line;
}

std::string FlirPtuEmulator::with_faults(std::string line) {
  if (roll() < faults.limit_report_share) {
    const auto at = std::uniform_int_distribution<std::size_t>(0, line.size())(random_);
    line.insert(at, roll() < 0.5 ? "!P" : "!T");
    ++limit_reports_;
  }
  if (roll() < faults.noise_share) {
    const int count = std::uniform_int_distribution<>(1, 8)(random_);
    std::string noise;
    // Noise is any byte but those that begin a reply: the protocol cannot distinguish such noise.
    while (static_cast<int>(noise.size()) < count) {
      const char byte = static_cast<char>(std::uniform_int_distribution<>(1, 255)(random_));
      if (byte != '*' && byte != '!') noise += byte;
    }
    line.insert(0, noise);
  }
  return line;
}

Result<std::size_t> FlirPtuLine::read(std::span<std::uint8_t> out, Duration timeout) {
  if (unplugged) return Error{ErrorCode::kDevice, "emulated line: unplugged"};
  std::string& waiting = unit_.output();
  const std::size_t count = std::min({waiting.size(), out.size(), longest_read});
  if (count == 0) {
    clock_.sleep_until(clock_.now() + timeout);
    return std::size_t{0};
  }
  clock_.sleep_until(clock_.now() + time_of(count));
  std::copy_n(waiting.begin(), count, out.begin());
  if (!understood()) std::fill_n(out.begin(), count, std::uint8_t{0xFF});
  waiting.erase(0, count);
  return count;
}

Result<void> FlirPtuLine::write(std::span<const std::uint8_t> bytes) {
  if (unplugged) return Error{ErrorCode::kDevice, "emulated line: unplugged"};
  clock_.sleep_until(clock_.now() + time_of(bytes.size()));
  constexpr std::uint8_t kWrongBits[] = {0xF8};
  unit_.receive(understood() ? bytes : std::span<const std::uint8_t>(kWrongBits), clock_.now());
  return {};
}

Result<void> FlirPtuLine::set_line(const device::LineSettings& settings) {
  baud = settings.baud;
  return {};
}

/// Time of bytes on the line, start and stop bits included.
Duration FlirPtuLine::time_of(std::size_t bytes) const {
  return std::chrono::nanoseconds(10'000'000'000 / baud) * static_cast<long>(bytes);
}

}  // namespace mixrig::fake

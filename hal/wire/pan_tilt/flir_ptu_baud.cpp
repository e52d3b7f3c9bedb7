// SPDX-License-Identifier: Apache-2.0
#include "hal/wire/pan_tilt/flir_ptu_baud.h"

#include <array>
#include <string_view>

#include "hal/wire/pan_tilt/flir_ptu_reply.h"

namespace mixrig::device {
namespace {

constexpr Duration kBaudAnswer = std::chrono::milliseconds(300);
constexpr Duration kBaudQuiet = std::chrono::milliseconds(60);

Result<void> send(ByteStream& line, std::string_view text) {
  return line.write({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

/// Reads until `until`, or until the line was quiet for a while; true if a position was among it.
Result<bool> hears_position(ByteStream& line, Clock& clock, Duration patience, Duration quiet) {
  PtuReplyParser parser;
  std::array<std::uint8_t, 64> bytes;
  const HostTime end = clock.now() + patience;
  while (clock.now() < end) {
    MIXRIG_ASSIGN(const std::size_t count, line.read(bytes, quiet));
    if (count == 0) break;
    for (std::size_t i = 0; i < count; ++i)
      if (const auto reply = parser.feed(static_cast<char>(bytes[i]));
          reply && reply->ok && ptu_number(reply->view()))
        return true;
  }
  return false;
}

Result<bool> answers(ByteStream& line, Clock& clock) {
  MIXRIG_TRY(send(line, " "));  // ends what another rate has left in the unit
  MIXRIG_TRY(hears_position(line, clock, kBaudAnswer, kBaudQuiet));
  MIXRIG_TRY(send(line, "PP "));
  return hears_position(line, clock, kBaudAnswer, kBaudAnswer);
}

}  // namespace

Result<int> find_ptu_baud(ByteStream& line, Clock& clock) {
  for (int round = 0; round < 2; ++round)
    for (const int baud : {9600, 19200, 38400, 57600, 115200}) {
      MIXRIG_TRY(line.set_line({.baud = baud}));
      MIXRIG_ASSIGN(const bool there, answers(line, clock));
      if (there) return baud;
    }
  return Error{ErrorCode::kTimeout,
               "no pan-tilt unit answers at 9600 to 115200 baud: check power and cable"};
}

}  // namespace mixrig::device

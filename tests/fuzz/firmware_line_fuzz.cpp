// SPDX-License-Identifier: Apache-2.0
// Any bytes on the line of the trigger controller: it must not crash and must answer Hello
// afterwards.
#include <cstdint>
#include <cstdlib>
#include <span>

#include "firmware/port/sim/sim_board.h"
#include "tests/fuzz/target.h"

MIXRIG_FUZZ_TARGET(firmware_line) {
  using namespace mixrig;
  sim::SimBoard board;
  board.receive({data, size});
  board.advance_by(50'000);
  if (board.in_bootloader()) return 0;
  board.transmitted();
  std::array<std::uint8_t, protocol::kMaxBody> body;
  std::array<std::uint8_t, protocol::kMaxWire> wire;
  const std::size_t n = protocol::write_message(protocol::Hello{protocol::kTableHash}, body);
  const std::size_t sent = protocol::encode_frame(protocol::Hello::kId, 1, {body.data(), n}, wire);
  board.receive({wire.data(), sent});
  if (board.transmitted().empty()) std::abort();
  return 0;
}

// SPDX-License-Identifier: Apache-2.0
// Any bytes from a pan-tilt unit: replies stay bounded, and numbers are finite.
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "hal/wire/pan_tilt/flir_ptu_reply.h"
#include "tests/fuzz/target.h"

MIXRIG_FUZZ_TARGET(ptu_reply) {
  using namespace mixrig::device;
  PtuReplyParser parser;
  parser.expect("PP ");
  for (std::size_t i = 0; i < size; ++i) {
    const auto reply = parser.feed(static_cast<char>(data[i]));
    if (!reply) continue;
    if (reply->size > reply->text.size()) std::abort();
    if (const auto number = ptu_number(reply->view()); number && !std::isfinite(*number))
      std::abort();
    (void)ptu_axis(reply->view());
    if (data[i] % 2 == 0) parser.expect("TP ");
  }
  if (parser.noise_bytes() > size) std::abort();
  return 0;
}

// SPDX-License-Identifier: Apache-2.0
// Any bytes as held controls of a camera; accepted ones are written and must read back the same.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "host/capture/live/rig/held_controls.h"
#include "tests/fuzz/target.h"

MIXRIG_FUZZ_TARGET(held_controls) {
  using namespace mixrig::live;
  const auto held = parse_held({reinterpret_cast<const char*>(data), size}, "held.toml");
  if (!held) return 0;
  const std::string text = held_text(*held);
  const auto again = parse_held(text, "held.toml");
  if (!again || held_text(*again) != text) std::abort();
  return 0;
}

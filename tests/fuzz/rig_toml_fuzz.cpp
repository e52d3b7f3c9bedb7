// SPDX-License-Identifier: Apache-2.0
// Any bytes as rig.toml; an accepted one is written and must read back as the same rig.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "host/capture/live/rig/rig_config.h"
#include "tests/fuzz/target.h"

MIXRIG_FUZZ_TARGET(rig_toml) {
  using namespace mixrig::live;
  const auto rig = parse_rig({reinterpret_cast<const char*>(data), size}, "rig.toml");
  if (!rig) return 0;
  const std::string text = rig_text(*rig);
  const auto again = parse_rig(text, "rig.toml");
  if (!again || rig_text(*again) != text) std::abort();
  return 0;
}

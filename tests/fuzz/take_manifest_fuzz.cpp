// SPDX-License-Identifier: Apache-2.0
// Any bytes as take.toml; an accepted one is written and read again.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "host/capture/take/manifest.h"
#include "tests/fuzz/target.h"

MIXRIG_FUZZ_TARGET(take_manifest) {
  using namespace mixrig;
  const auto manifest =
      take::parse_manifest({reinterpret_cast<const char*>(data), size}, "t/take.toml");
  if (!manifest) return 0;
  const auto again = take::parse_manifest(take::manifest_text(manifest->info), "t/take.toml");
  if (!again || again->info.color != manifest->info.color) std::abort();
  return 0;
}

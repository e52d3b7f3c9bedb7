// SPDX-License-Identifier: Apache-2.0
// Any bytes as FreeD packets: an accepted packet is written as the same bytes. Any text as the
// address that packets come to.
#include <algorithm>
#include <cstdlib>
#include <string>

#include "extras/broadcast/packets/freed.h"
#include "extras/broadcast/packets/freed_receiver.h"
#include "tests/fuzz/target.h"

MIXRIG_FUZZ_TARGET(freed) {
  using namespace mixrig::stream;
  const auto bytes = std::as_bytes(std::span(data, size));
  const std::string text(reinterpret_cast<const char*>(data), size);
  if (const auto listen = parse_freed_address("freed:" + text);
      listen && (listen->port < 0 || listen->port > 65535))
    std::abort();
  const auto packet = parse_freed(bytes);
  if (!packet) return 0;
  const auto again = freed_bytes(*packet);
  if (!std::equal(again.begin(), again.end(), bytes.begin(), bytes.end())) std::abort();
  return 0;
}

// SPDX-License-Identifier: Apache-2.0
// Any text as the addresses of --page, --osc-in and --page-proxy, and of motion capture: an error
// is one line, and an address has a port.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "host/operator/page/server.h"
#include "host/pose/mocap/natnet_receiver.h"
#include "tests/fuzz/target.h"

MIXRIG_FUZZ_TARGET(listen_address) {
  using namespace mixrig;
  const std::string text(reinterpret_cast<const char*>(data), size);
  for (const auto& listen : {page::parse_listen(text), page::parse_osc_listen(text)})
    if (listen && listen->address.empty()) std::abort();
  if (page::check_proxied(text) && text.find_first_of("/@? \r\n") != std::string::npos)
    std::abort();
  if (const auto server = stream::parse_natnet_address("natnet:" + text);
      server && (server->host.empty() || server->command_port < 1 || server->command_port > 65535))
    std::abort();
  return 0;
}

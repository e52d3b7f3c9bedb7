// SPDX-License-Identifier: Apache-2.0
// Datagrams of control surfaces: messages stay within their bounds, and become actions or one-line
// errors.
#include <cstdlib>
#include <string_view>

#include "host/operator/page/osc/osc_commands.h"
#include "host/operator/page/state_json.h"
#include "tests/fuzz/target.h"

MIXRIG_FUZZ_TARGET(osc) {
  using namespace mixrig;
  static const nlohmann::json state = [] {
    page::State made;
    made.objects.push_back({.name = "crate"});
    made.lamps.push_back({.name = "key"});
    made.cameras.push_back({"color", {{"exposure_ms", 5, 1, 40, 1}}});
    return page::to_json(made, {});
  }();
  const auto messages = stream::parse_osc({data, size});
  if (!messages) return 0;
  if (messages->size() > 32) std::abort();
  for (const stream::OscReceived& message : *messages) {
    if (message.arguments.size() > 16) std::abort();
    const auto action = page::action_of(message, state);
    if (!action && action.error().context.empty()) std::abort();
  }
  return 0;
}

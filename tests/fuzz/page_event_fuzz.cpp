// SPDX-License-Identifier: Apache-2.0
// Messages of the page's event socket: each is answered with JSON that states whether it was done.
#include <cstdlib>
#include <string_view>

#include "host/operator/page/events.h"
#include "host/operator/page/state_json.h"
#include "tests/fuzz/target.h"

MIXRIG_FUZZ_TARGET(page_event) {
  using namespace mixrig::page;
  static const nlohmann::json state = to_json({}, {});
  Subscriptions subscriptions;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto answer = nlohmann::json::parse(subscriptions.answer(text, state, 1), nullptr, false);
  if (!answer.is_object() || !answer["data"]["success"].is_boolean()) std::abort();
  if (!subscriptions.changed(state).empty()) std::abort();
  return 0;
}

// SPDX-License-Identifier: Apache-2.0
// Requests of the page's interface (METHOD TARGET, a line end, the body): each becomes a command or
// a refusal in JSON.
#include <algorithm>
#include <cstdlib>
#include <string_view>

#include <nlohmann/json.hpp>

#include "host/operator/page/route.h"
#include "tests/fuzz/target.h"

namespace {

using namespace mixrig::page;

void check(const Answer& answer) {
  if (answer.status < 400 || !nlohmann::json::accept(answer.body)) std::abort();
}

void act(const Change& change, std::string_view body) {
  const auto action = action_of(change, body);
  if (!action) return check(refusal(action.error()));
  const auto* command = std::get_if<Command>(&*action);
  if (command == nullptr) return;
  if (const auto* set = std::get_if<SetObject>(command))
    if (!is_name(set->name) || (set->at && !set->at->allFinite())) std::abort();
  if (const auto* start = std::get_if<StartRecording>(command))
    if (start->name.find('/') != std::string::npos || start->name.starts_with('.')) std::abort();
}

}  // namespace

MIXRIG_FUZZ_TARGET(page_request) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const std::size_t line = std::min(text.find('\n'), text.size());
  const std::string_view head = text.substr(0, line);
  const std::string_view body = text.substr(std::min(line + 1, text.size()));
  Request request;
  request.target = head.substr(std::min(head.find('/'), head.size()));
  request.host = request.cookie = request.content_type = request.origin = body;
  for (const Guard& guard : {Guard{}, Guard{"0123456789abcdef0123456789abcdef"}}) {
    if (const auto refused = refuse(guard, request)) check(*refused);
    (void)first_visit(guard, request);
  }
  for (const Method method : {Method::kGet, Method::kPut, Method::kPost, Method::kDelete}) {
    const Route route = route_of(method, request.target);
    if (const auto* answer = std::get_if<Answer>(&route)) check(*answer);
    if (const auto* change = std::get_if<Change>(&route)) act(*change, body);
  }
  return 0;
}

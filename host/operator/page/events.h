// SPDX-License-Identifier: Apache-2.0
// Messages of the event socket, in the shape that Blackmagic's cameras have made common. Pure.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace mixrig::page {

inline constexpr std::size_t kMostMessage = 4096;

/// What one client has subscribed to: "/objects" for the part "objects".
class Subscriptions {
 public:
  /// The answer to a message: to subscribe, unsubscribe ({"properties": ["/view", ...]} or ["*"]),
  /// listSubscriptions, listProperties; "time" gives the host's clock, by which the age of a
  /// picture is told. Anything else is answered with success false and why. `state` as to_json().
  std::string answer(std::string_view message, const nlohmann::json& state, double host_ms);
  bool has(std::string_view part) const { return parts_.contains(part); }
  /// Parts that were subscribed to and whose values are not those that were told last; then they
  /// count as told. Memory: one hash a part.
  std::vector<std::string> changed(const nlohmann::json& state);

 private:
  nlohmann::json handle(const nlohmann::json& request, const nlohmann::json& state, double host_ms);
  nlohmann::json subscribe(const nlohmann::json& data, const nlohmann::json& state, bool on);

  std::set<std::string, std::less<>> parts_;
  std::map<std::string, std::size_t, std::less<>> told_;
};

/// The first message of a socket.
std::string opened_message();
/// {"type": "event", "data": {"action": "propertyValueChanged", "property": "/view", "value": ...}}
std::string changed_message(std::string_view part, const nlohmann::json& value);

}  // namespace mixrig::page

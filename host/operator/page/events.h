// SPDX-License-Identifier: Apache-2.0
// Messages of the event socket, in the format of Blackmagic's cameras. Pure.
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

/// Parts that one client has subscribed to: "/objects" for the part "objects".
class Subscriptions {
 public:
  /// Answers a message: subscribe, unsubscribe ({"properties": ["/view", ...]} or ["*"]),
  /// listSubscriptions or listProperties; "time" returns the host's clock, from which clients
  /// compute the age of a picture. Other messages are answered with success false and the reason.
  /// `state`: as from to_json().
  std::string answer(std::string_view message, const nlohmann::json& state, double host_ms);
  bool has(std::string_view part) const { return parts_.contains(part); }
  /// Subscribed parts whose values differ from those last sent; they count as sent from then on.
  /// Keeps one hash for each part.
  std::vector<std::string> changed(const nlohmann::json& state);

 private:
  nlohmann::json handle(const nlohmann::json& request, const nlohmann::json& state, double host_ms);
  nlohmann::json subscribe(const nlohmann::json& data, const nlohmann::json& state, bool on);

  std::set<std::string, std::less<>> parts_;
  std::map<std::string, std::size_t, std::less<>> told_;
};

/// The first message of a socket.
std::string opened_message();
/// Event of a changed part: {"type": "event", "data": {"action": "propertyValueChanged",
/// "property": "/view", "value": ...}}
std::string changed_message(std::string_view part, const nlohmann::json& value);

}  // namespace mixrig::page

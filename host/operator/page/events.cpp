// SPDX-License-Identifier: Apache-2.0
#include "host/operator/page/events.h"

#include <functional>

#include "host/operator/page/json_body.h"
#include "host/operator/page/state_json.h"

namespace mixrig::page {
namespace {

using nlohmann::json;

json failed(const std::string& action, const std::string& why) {
  return {{"action", action}, {"success", false}, {"error", why}};
}

json property_names(const std::set<std::string, std::less<>>& parts) {
  json names = json::array();
  for (const std::string& part : parts) names.push_back("/" + part);
  return names;
}

std::size_t hash_of(const json& value) { return std::hash<std::string>{}(to_text(value)); }

/// The part of "/objects"; empty for none.
std::string part_of(const json& property) {
  if (!property.is_string()) return {};
  const auto& text = property.get_ref<const std::string&>();
  if (text.size() < 2 || text.front() != '/' || !is_part(text.substr(1))) return {};
  return text.substr(1);
}

/// The names of a list of properties; "*" is all. False where one is unknown.
bool parts_of(const json& data, std::set<std::string, std::less<>>& named) {
  const auto properties = data.find("properties");
  if (properties == data.end() || !properties->is_array() || properties->empty()) return false;
  for (const json& property : *properties) {
    if (property == "*") {
      for (const std::string_view part : parts()) named.emplace(part);
      continue;
    }
    const std::string part = part_of(property);
    if (part.empty()) return false;
    named.insert(part);
  }
  return true;
}

}  // namespace

json Subscriptions::subscribe(const json& data, const json& state, bool on) {
  const std::string action = on ? "subscribe" : "unsubscribe";
  std::set<std::string, std::less<>> named;
  if (!parts_of(data, named))
    return failed(action, "properties is a list of names that listProperties gives");
  json answer{{"action", action}, {"properties", property_names(named)}, {"success", true}};
  for (const std::string& part : named) {
    if (!on) {
      parts_.erase(part), told_.erase(part);
      continue;
    }
    parts_.insert(part);
    told_[part] = hash_of(state.at(part));
    answer["values"]["/" + part] = state.at(part);
  }
  return answer;
}

json Subscriptions::handle(const json& data, const json& state, double host_ms) {
  const auto found = data.find("action");
  const std::string action =
      found != data.end() && found->is_string() ? found->get<std::string>() : "";
  if (action == "subscribe" || action == "unsubscribe")
    return subscribe(data, state, action == "subscribe");
  if (action == "listSubscriptions")
    return {{"action", action}, {"properties", property_names(parts_)}, {"success", true}};
  if (action == "listProperties") {
    std::set<std::string, std::less<>> all;
    for (const std::string_view part : parts()) all.emplace(part);
    return {{"action", action}, {"properties", property_names(all)}, {"success", true}};
  }
  if (action == "time") return {{"action", action}, {"host_ms", host_ms}, {"success", true}};
  return failed(action.substr(0, 64),
                "the action is one of subscribe, unsubscribe, listSubscriptions, listProperties "
                "and time");
}

std::string Subscriptions::answer(std::string_view message, const json& state, double host_ms) {
  json answer{{"type", "response"}};
  const auto request = parse_json(message);
  if (!request || !request->is_object()) {
    answer["data"] =
        failed("", request ? "the message is no JSON object" : to_line(request.error()));
    return to_text(answer);
  }
  const auto id = request->find("id");
  if (id != request->end() && id->is_number_integer()) answer["id"] = *id;
  const auto data = request->find("data");
  const bool fine =
      request->value("type", json()) == "request" && data != request->end() && data->is_object();
  answer["data"] =
      fine ? handle(*data, state, host_ms)
           : failed("", "a message is {\"type\": \"request\", \"data\": {\"action\": ...}}");
  return to_text(answer);
}

std::vector<std::string> Subscriptions::changed(const json& state) {
  std::vector<std::string> changed;
  for (const std::string& part : parts_) {
    const std::size_t hash = hash_of(state.at(part));
    std::size_t& told = told_[part];
    if (hash != told) changed.push_back(part);
    told = hash;
  }
  return changed;
}

std::string opened_message() {
  return to_text({{"type", "event"}, {"data", {{"action", "websocketOpened"}}}});
}

std::string changed_message(std::string_view part, const json& value) {
  return to_text({{"type", "event"},
                  {"data",
                   {{"action", "propertyValueChanged"},
                    {"property", "/" + std::string(part)},
                    {"value", value}}}});
}

}  // namespace mixrig::page

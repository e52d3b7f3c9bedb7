// SPDX-License-Identifier: Apache-2.0
#include "host/operator/page/osc/osc_commands.h"

#include <algorithm>
#include <optional>

#include "host/operator/page/json_body.h"
#include "host/output/datagrams/osc.h"

namespace mixrig::page {
namespace {

using nlohmann::json;
using stream::OscArgument;
using stream::OscReceived;

constexpr std::string_view kRoot = "/mixrig/";

Error not_there(const std::string& address) {
  return {ErrorCode::kNotFound, address + ": there is nothing under this address"};
}
Error not_so(const OscReceived& message, const char* what) {
  return {ErrorCode::kUsage, message.address + ": " + what};
}

std::vector<std::string> parts_of_address(std::string_view address) {
  std::vector<std::string> parts;
  while (!address.empty()) {
    const auto end = std::min(address.find('/'), address.size());
    parts.emplace_back(address.substr(0, end));
    address.remove_prefix(std::min(end + 1, address.size()));
  }
  return parts;
}

/// Value of a switch: true, false, 1 or 0; a message without arguments toggles it.
Result<bool> switch_of(const OscReceived& message, bool now) {
  if (message.arguments.empty()) return !now;
  const OscArgument& first = message.arguments.front();
  if (const bool* on = std::get_if<bool>(&first)) return *on;
  if (const double* on = std::get_if<double>(&first)) return *on != 0;
  return not_so(message, "give 1 or 0, or nothing to toggle");
}

/// One number, or an array of them.
Result<json> numbers_of(const OscReceived& message) {
  json numbers = json::array();
  for (const OscArgument& argument : message.arguments) {
    const double* number = std::get_if<double>(&argument);
    if (number == nullptr) return not_so(message, "its arguments are numbers");
    numbers.push_back(*number);
  }
  if (numbers.empty()) return not_so(message, "a number is missing");
  return numbers.size() == 1 ? numbers[0] : numbers;
}

/// The thing of a list whose name is written so in an address; null: none.
const json* thing_named(const json& list, const std::string& osc_name) {
  for (const json& thing : list)
    if (stream::osc_name(thing.at("name").get_ref<const std::string&>()) == osc_name) return &thing;
  return nullptr;
}

bool is_one_of(std::string_view text, std::initializer_list<std::string_view> all) {
  return std::find(all.begin(), all.end(), text) != all.end();
}

/// The body that REST would have: "turn_deg" of an object, "exposure_ms" of a camera.
Result<json> body_of(const OscReceived& message, const std::string& kind, const std::string& key,
                     const json& thing) {
  const bool is_switch = (kind == "objects" && key == "hidden") || (kind == "lamps" && key == "on");
  if (is_switch) {
    MIXRIG_ASSIGN(const bool on, switch_of(message, thing.at(key).get<bool>()));
    return json{{key, on}};
  }
  const bool is_number =
      kind == "objects" ? is_one_of(key, {"turn_deg", "scale", "at", "onto", "position_m"})
      : kind == "lamps"
          ? key == "intensity"
          : is_one_of(key, {"exposure_ms", "gain", "focus", "white_balance_k", "zoom"});
  if (!is_number) return not_there(message.address);
  MIXRIG_ASSIGN(json value, numbers_of(message));
  if (kind == "lamps" && value.is_number()) value = json::array({value, value, value});
  return json{{key, value}};
}

/// Action of an address of one object, lamp or camera, such as /mixrig/lamp/NAME/on.
Result<Action> thing_action(const OscReceived& message, const std::vector<std::string>& parts,
                            const json& state) {
  const std::string kind = parts[0] + "s";
  const json* thing = thing_named(state.at(kind), parts[1]);
  if (thing == nullptr)
    return Error{ErrorCode::kNotFound,
                 message.address + ": there is no " + parts[0] + " of this name"};
  MIXRIG_ASSIGN(const json body, body_of(message, kind, parts[2], *thing));
  return action_of(Change{Method::kPut, kind, thing->at("name").get<std::string>()}, to_text(body));
}

Result<Action> record_action(const OscReceived& message, bool now) {
  MIXRIG_ASSIGN(const bool on, switch_of(message, now));
  if (!on) return Action(Command(StopRecording{}));
  json body = json::object();
  if (message.arguments.size() > 1) {
    const std::string* name = std::get_if<std::string>(&message.arguments[1]);
    if (name == nullptr) return not_so(message, "the name of the take is a text");
    body["name"] = *name;
  }
  return action_of(Change{Method::kPost, "record", "start"}, to_text(body));
}

Result<Action> simple_action(const OscReceived& message, const std::string& verb,
                             const json& state) {
  if (verb == "record") return record_action(message, state.at("recording").at("on").get<bool>());
  if (verb == "freeze") {
    MIXRIG_ASSIGN(const bool on, switch_of(message, state.at("freeze").get<bool>()));
    return Action(output::RunOrder(output::FreezePictures{on}));
  }
  if (verb == "scan") {
    MIXRIG_ASSIGN(const bool on, switch_of(message, state.at("scan").at("total").get<int>() > 0));
    return Action(Command(ScanRoom{on}));
  }
  if (verb == "sweep") {
    MIXRIG_ASSIGN(const bool on, switch_of(message, state.at("sweep").at("phase") != "idle"));
    return on ? Action(Command(StartSweep{})) : Action(Command(CancelSweep{}));
  }
  if (verb == "learn") return Action(Command(LearnBackground{}));
  if (verb == "save") return Action(Command(SaveScene{}));
  if (verb == "undo" || verb == "redo") return Action(Command(Undo{verb == "redo"}));
  if (verb != "view") return not_there(message.address);
  const std::string* name =
      message.arguments.empty() ? nullptr : std::get_if<std::string>(&message.arguments.front());
  const auto view = name != nullptr ? view_named(*name) : std::nullopt;
  if (!view) return not_so(message, "give composite, plate, key, depth, light or matte");
  return Action(output::RunOrder(output::ShowView{*view}));
}

/// Action of /mixrig/focus/KEY with KEY on, at, distance_m or f_number.
Result<Action> focus_action(const OscReceived& message, const std::string& key, const json& focus) {
  json value;
  if (key == "on") {
    MIXRIG_ASSIGN(value, switch_of(message, focus.at("on").get<bool>()));
  } else {
    if (!is_one_of(key, {"at", "distance_m", "f_number"})) return not_there(message.address);
    MIXRIG_ASSIGN(value, numbers_of(message));
  }
  return action_of(Change{Method::kPut, "focus", ""}, to_text(json{{key, value}}));
}

class OscState {
 public:
  template <typename Fill>
  void put(const std::string& address, Fill&& fill) {
    stream::OscMessage message(std::string(kRoot) + address);
    fill(message);
    datagrams_[std::string(kRoot) + address] = message.bytes();
  }
  void put_switch(const std::string& address, bool on) {
    put(address, [&](stream::OscMessage& m) { m.add(std::int32_t{on}); });
  }
  void put_text(const std::string& address, const std::string& text) {
    put(address, [&](stream::OscMessage& m) { m.add(std::string_view(text)); });
  }
  void put_numbers(const std::string& address, const json& values) {
    put(address, [&](stream::OscMessage& m) {
      for (const json& value : values.is_array() ? values : json::array({values}))
        if (value.is_number()) m.add(value.get<float>());
    });
  }
  std::map<std::string, std::string> take() { return std::move(datagrams_); }

 private:
  std::map<std::string, std::string> datagrams_;
};

}  // namespace

Result<std::optional<Action>> action_of(const OscReceived& message, const json& state) {
  if (!message.address.starts_with(kRoot)) return not_there(message.address);
  const auto parts = parts_of_address(std::string_view(message.address).substr(kRoot.size()));
  if (parts.size() == 1 && parts[0] == "state") return std::optional<Action>();
  if (parts.size() == 1) {
    MIXRIG_ASSIGN(Action action, simple_action(message, parts[0], state));
    return std::optional(std::move(action));
  }
  if (parts.size() == 2 && parts[0] == "focus") {
    MIXRIG_ASSIGN(Action action, focus_action(message, parts[1], state.at("focus")));
    return std::optional(std::move(action));
  }
  if (parts.size() != 3 || !is_one_of(parts[0], {"object", "lamp", "camera"}))
    return not_there(message.address);
  MIXRIG_ASSIGN(Action action, thing_action(message, parts, state));
  return std::optional(std::move(action));
}

std::map<std::string, std::string> osc_of(const json& state) {
  OscState osc;
  const json& recording = state.at("recording");
  osc.put_switch("record", recording.at("on").get<bool>());
  osc.put_text("tally", recording.at("tally").get<std::string>());
  osc.put_text("take", recording.at("name").get<std::string>());
  osc.put_text("view", state.at("view").get<std::string>());
  osc.put_switch("freeze", state.at("freeze").get<bool>());
  osc.put_switch("learn", state.at("background").at("possible").get<bool>());
  const json& scan = state.at("scan");
  const int total = scan.at("total").get<int>();
  osc.put_numbers("scan", total > 0 ? scan.at("done").get<double>() / total : 0.0);
  const json& sweep = state.at("sweep");
  const int views = sweep.at("phase") == "sweeping" ? sweep.at("total").get<int>() : 0;
  osc.put_numbers("sweep", views > 0 ? sweep.at("done").get<double>() / views : 0.0);
  const json& focus = state.at("focus");
  osc.put_switch("focus/on", focus.at("on").get<bool>());
  for (const char* key : {"at", "distance_m", "f_number"})
    osc.put_numbers(std::string("focus/") + key, focus.at(key));
  for (const json& o : state.at("objects")) {
    const std::string at = "object/" + stream::osc_name(o.at("name").get<std::string>()) + "/";
    osc.put_switch(at + "hidden", o.at("hidden").get<bool>());
    for (const char* key : {"turn_deg", "scale", "position_m"})
      osc.put_numbers(at + key, o.at(key));
  }
  for (const json& l : state.at("lamps")) {
    const std::string at = "lamp/" + stream::osc_name(l.at("name").get<std::string>()) + "/";
    osc.put_switch(at + "on", l.at("on").get<bool>());
    osc.put_numbers(at + "intensity", l.at("intensity"));
  }
  for (const json& c : state.at("cameras")) {
    const std::string at = "camera/" + stream::osc_name(c.at("name").get<std::string>()) + "/";
    for (const json& setting : c.at("settings"))
      osc.put_numbers(at + setting.at("name").get<std::string>(), setting.at("value"));
  }
  return osc.take();
}

}  // namespace mixrig::page

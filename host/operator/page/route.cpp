// SPDX-License-Identifier: Apache-2.0
#include "host/operator/page/route.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>

#include <nlohmann/json.hpp>

#include "host/operator/page/json_body.h"
#include "host/operator/page/state_json.h"

namespace mixrig::page {
namespace {

using Parts = std::vector<std::string>;
using nlohmann::json;

Answer no_such() { return refusal(404, "there is nothing under this address: see /api/v1/state"); }
Answer wrong_method(std::string_view allowed) {
  Answer answer = refusal(405, "this method is not served here: use " + std::string(allowed));
  answer.headers.emplace_back("Allow", allowed);
  return answer;
}

Route file_route(Method method, const Parts& parts) {
  if (method != Method::kGet) return wrong_method("GET");
  if (parts.empty()) return GetFile{"index.html"};
  return parts.size() == 1 ? Route(GetFile{parts[0]}) : Route(no_such());
}

/// "composite.mjpeg", "key.jpg", "composite.webrtc".
Route picture_route(Method method, const std::string& file) {
  const std::size_t dot = file.rfind('.');
  const auto view = view_named(file.substr(0, dot));
  const std::string kind = dot == std::string::npos ? "" : file.substr(dot + 1);
  if (!view || (kind != "mjpeg" && kind != "jpg" && kind != "webrtc")) return no_such();
  if (method != Method::kGet) return wrong_method("GET");
  if (kind == "webrtc") return WatchPicture{*view};
  return GetPicture{*view, kind == "mjpeg"};
}

/// /cameras, /cameras/NAME.
Route camera_route(Method method, const Parts& rest) {
  if (rest.empty())
    return method == Method::kGet ? Route(GetState{"cameras"}) : Route(wrong_method("GET"));
  if (rest.size() != 1 || !is_name(rest[0])) return no_such();
  if (method != Method::kPut) return wrong_method("PUT");
  return Change{method, "cameras", rest[0]};
}

/// /presets, /presets/NAME, /presets/NAME/recall.
Route preset_route(Method method, const Parts& rest) {
  if (rest.empty())
    return method == Method::kGet ? Route(GetState{"presets"}) : Route(wrong_method("GET"));
  if (!is_folder_name(rest[0])) return no_such();
  if (rest.size() == 2 && rest[1] == "recall")
    return method == Method::kPost ? Route(Change{method, "recall", rest[0]})
                                   : Route(wrong_method("POST"));
  if (rest.size() != 1) return no_such();
  if (method == Method::kPut || method == Method::kDelete)
    return Change{method, "presets", rest[0]};
  return wrong_method("PUT, DELETE");
}

/// /takes, /takes/NAME.
Route take_route(Method method, const Parts& rest) {
  if (rest.empty())
    return method == Method::kGet ? Route(GetState{"takes"}) : Route(wrong_method("GET"));
  if (rest.size() != 1 || !is_folder_name(rest[0])) return no_such();
  if (method != Method::kPut) return wrong_method("PUT");
  return Change{method, "takes", rest[0]};
}

/// /objects, /objects/NAME, /objects/NAME/copy, /lamps, /lamps/NAME; a lamp is added by POST
/// /lamps, an object by POST /objects/NAME.
Route thing_route(Method method, const std::string& kind, const Parts& rest) {
  const bool lamps = kind == "lamps";
  if (rest.empty()) {
    if (method == Method::kGet) return GetState{kind};
    if (lamps && method == Method::kPost) return Change{method, kind, ""};
    return wrong_method(lamps ? "GET, POST" : "GET");
  }
  if (!is_name(rest[0])) return no_such();
  if (!lamps && rest.size() == 2 && rest[1] == "copy")
    return method == Method::kPost ? Route(Change{method, "copy", rest[0]})
                                   : Route(wrong_method("POST"));
  if (rest.size() != 1) return no_such();
  if (!lamps && method == Method::kPost) return Upload{rest[0]};
  if (method == Method::kPut || method == Method::kDelete) return Change{method, kind, rest[0]};
  return wrong_method(lamps ? "PUT, DELETE" : "PUT, POST, DELETE");
}

Route post_route(Method method, const std::string& kind, const std::string& verb) {
  if (method != Method::kPost) return wrong_method("POST");
  return Change{method, kind, verb};
}

Route api_route(Method method, const Parts& parts) {
  const std::string& kind = parts[2];
  const Parts rest(parts.begin() + 3, parts.end());
  if (kind == "objects" || kind == "lamps") return thing_route(method, kind, rest);
  if (kind == "cameras") return camera_route(method, rest);
  if (kind == "presets") return preset_route(method, rest);
  if (kind == "takes") return take_route(method, rest);
  if (kind == "picture" && rest.size() == 1) return picture_route(method, rest[0]);
  if (kind == "event" && rest.size() == 1 && rest[0] == "websocket")
    return method == Method::kGet ? Route(OpenEvents{}) : Route(wrong_method("GET"));
  if ((kind == "view" || kind == "freeze" || kind == "focus") && rest.empty()) {
    if (method == Method::kPut) return Change{method, kind, ""};
    return method == Method::kGet ? Route(GetState{kind}) : Route(wrong_method("GET, PUT"));
  }
  if (kind == "record" && rest.size() == 1 && (rest[0] == "start" || rest[0] == "stop"))
    return post_route(method, kind, rest[0]);
  if (kind == "scene" && rest.size() == 1 &&
      (rest[0] == "save" || rest[0] == "discard" || rest[0] == "undo" || rest[0] == "redo"))
    return post_route(method, kind, rest[0]);
  if (kind == "background" && rest.size() == 1 &&
      (rest[0] == "learn" || rest[0] == "scan" || rest[0] == "cancel"))
    return post_route(method, kind, rest[0]);
  if (kind == "sweep" && rest.size() == 1 && (rest[0] == "start" || rest[0] == "cancel"))
    return post_route(method, kind, rest[0]);
  if (!rest.empty() || !(kind == "state" || is_part(kind))) return no_such();
  if (method != Method::kGet) return wrong_method("GET");
  return GetState{kind == "state" ? "" : kind};
}

Result<Action> set_object(const std::string& name, const Body& body) {
  SetObject set{.name = name};
  set.position_m = body.numbers<3>("position_m", -1e4, 1e4);
  set.at = body.numbers<2>("at", 0, 1);
  set.onto = body.numbers<2>("onto", 0, 1);
  if (const auto turn = body.number("turn_deg", -3600, 3600))
    set.turn_rad = *turn * std::numbers::pi / 180;
  set.scale = body.number("scale", 1e-3, 1e3);
  set.hidden = body.boolean("hidden");
  set.rename = body.name("name");
  set.preview = body.boolean("preview").value_or(false);
  if (set.position_m && set.at) body.fail("at", "is given beside position_m: remove one of them");
  if (set.onto && (set.position_m || set.at))
    body.fail("onto", "is given beside position_m or at: remove one of them");
  return body.done(Action(Command(set)));
}

Result<Action> set_lamp(const std::string& name, const Body& body) {
  SetLamp set{.name = name};
  if (const auto v = body.numbers<3>("intensity", 0, 1e6)) set.intensity = v->cast<float>();
  set.on = body.boolean("on");
  set.preview = body.boolean("preview").value_or(false);
  return body.done(Action(Command(set)));
}

/// Action that sets values of a camera. Only the camera knows their ranges.
Result<Action> set_camera(const std::string& name, const Body& body) {
  SetCamera set{.name = name, .values = {}};
  for (const char* key : {"exposure_ms", "gain", "focus", "white_balance_k", "zoom"})
    if (const auto value = body.number(key, -1e9, 1e9)) set.values.emplace_back(key, *value);
  set.preview = body.boolean("preview").value_or(false);
  if (set.values.empty()) body.fail("exposure_ms", "or another setting is needed");
  return body.done(Action(Command(set)));
}

Result<Action> add_lamp(const Body& body) {
  AddLamp add;
  add.name = body.name("name").value_or("");
  add.at = body.numbers<2>("at", 0, 1);
  add.position_m = body.numbers<3>("position_m", -1e4, 1e4);
  add.height_m = body.number("height_m", -100, 100);
  add.above_floor_m = body.number("above_floor_m", 0, 100);
  if (const auto v = body.numbers<3>("intensity", 0, 1e6)) add.intensity = v->cast<float>();
  if (add.at.has_value() == add.position_m.has_value())
    body.fail("at", "or position_m says where the lamp is: give one of them");
  if (int{add.height_m.has_value()} + int{add.above_floor_m.has_value()} > int{add.at.has_value()})
    body.fail("height_m", "or above_floor_m is given with at: give one of them");
  return body.done(Action(Command(add)));
}

Result<Action> start_recording(const Body& body) {
  StartRecording start{body.text("name", kMostName).value_or(""),
                       body.text("notes", kMostNotes).value_or("")};
  if (!start.name.empty() && !is_folder_name(start.name))
    body.fail("name", "becomes a folder: use letters, digits, blanks, '_', '-' and '.'");
  return body.done(Action(Command(start)));
}

Result<Action> start_sweep(const Body& body) {
  StartSweep start;
  start.name = body.text("name", kMostName).value_or("");
  if (!start.name.empty() && !is_folder_name(start.name))
    body.fail("name", "becomes a folder: use letters, digits, blanks, '_', '-' and '.'");
  if (const auto field = body.numbers<2>("field_deg", 1, 360)) start.field_deg = *field;
  if (start.field_deg.y() > 180) body.fail("field_deg", "must be at most 360 by 180");
  start.view_frames = static_cast<int>(body.number("view_frames", 1, 100).value_or(4));
  return body.done(Action(Command(start)));
}

Result<Action> set_focus(const Body& body) {
  SetFocus set;
  set.on = body.boolean("on");
  set.at = body.numbers<2>("at", 0, 1);
  set.distance_m = body.number("distance_m", 0.01, 1e4);
  set.f_number = body.number("f_number", 0.5, 128);
  if (set.at && set.distance_m) body.fail("at", "is given beside distance_m: remove one of them");
  return body.done(Action(Command(set)));
}

Result<Action> store_preset(const std::string& name, const Body& body) {
  return body.done(Action(Command(StorePreset{name, body.boolean("replace").value_or(false)})));
}

Result<Action> set_take(const std::string& name, const Body& body) {
  SetTake set{.name = name};
  set.circled = body.boolean("circled");
  set.notes = body.text("notes", kMostNotes);
  return body.done(Action(Command(set)));
}

/// "save", "discard", "undo" or "redo".
Result<Action> scene_action(const std::string& verb, const Body& body) {
  if (verb == "save") return body.done(Action(Command(SaveScene{})));
  if (verb == "discard") return body.done(Action(Command(DiscardPreviews{})));
  return body.done(Action(Command(Undo{verb == "redo"})));
}

Result<Action> select_view(const Body& body) {
  const auto text = body.text("view", 16);
  const auto view = view_named(text.value_or(""));
  if (!view) body.fail("view", "is one of composite, plate, key, depth, light and matte");
  return body.done(Action(output::RunOrder(output::ShowView{view.value_or(View::kComposite)})));
}

Result<Action> freeze(const Body& body) {
  const auto on = body.boolean("on");
  if (!on) body.fail("on", "is missing: give true or false");
  return body.done(Action(output::RunOrder(output::FreezePictures{on.value_or(false)})));
}

}  // namespace

bool is_name(std::string_view text) {
  if (text.empty() || text.size() > kMostName || !is_utf8(text)) return false;
  return std::none_of(text.begin(), text.end(), [](char c) {
    return static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) == 0x7F;
  });
}

bool is_folder_name(std::string_view text) {
  const auto is_good = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == ' ' ||
           c == '_' || c == '-' || c == '.';
  };
  return !text.empty() && text.size() <= kMostName && text.front() != '.' && text.front() != ' ' &&
         text.back() != ' ' && std::all_of(text.begin(), text.end(), is_good);
}

Route route_of(Method method, std::string_view target) {
  const auto parts = path_of(target);
  if (!parts) return no_such();
  if (parts->empty() || (*parts)[0] != "api") return file_route(method, *parts);
  if (parts->size() < 3 || (*parts)[1] != "v1") return no_such();
  return api_route(method, *parts);
}

Result<Action> action_of(const Change& change, std::string_view text) {
  MIXRIG_ASSIGN(const Body body, Body::parse(text));
  const bool remove = change.method == Method::kDelete;
  if (change.kind == "objects")
    return remove ? body.done(Action(Command(RemoveObject{change.name})))
                  : set_object(change.name, body);
  if (change.kind == "copy") return body.done(Action(Command(CopyObject{change.name})));
  if (change.kind == "recall") return body.done(Action(Command(RecallPreset{change.name})));
  if (change.kind == "presets")
    return remove ? body.done(Action(Command(RemovePreset{change.name})))
                  : store_preset(change.name, body);
  if (change.kind == "takes") return set_take(change.name, body);
  if (change.kind == "cameras") return set_camera(change.name, body);
  if (change.kind == "lamps" && change.name.empty()) return add_lamp(body);
  if (change.kind == "lamps")
    return remove ? body.done(Action(Command(RemoveLamp{change.name})))
                  : set_lamp(change.name, body);
  if (change.kind == "view") return select_view(body);
  if (change.kind == "freeze") return freeze(body);
  if (change.kind == "scene") return scene_action(change.name, body);
  if (change.kind == "background" && change.name == "learn")
    return body.done(Action(Command(LearnBackground{})));
  if (change.kind == "background")
    return body.done(Action(Command(ScanRoom{change.name == "scan"})));
  if (change.kind == "focus") return set_focus(body);
  if (change.kind == "sweep")
    return change.name == "start" ? start_sweep(body) : body.done(Action(Command(CancelSweep{})));
  if (change.name == "start") return start_recording(body);
  return body.done(Action(Command(StopRecording{})));
}

}  // namespace mixrig::page

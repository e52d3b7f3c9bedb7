// SPDX-License-Identifier: Apache-2.0
// Bodies of changes as commands.
#include <numbers>

#include "host/operator/page/json_body.h"
#include "host/operator/page/route.h"

namespace mixrig::page {
namespace {

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

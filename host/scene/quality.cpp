// SPDX-License-Identifier: Apache-2.0
#include "host/scene/quality.h"

#include "host/scene/read_quality.h"
#include "host/scene/scene.h"

namespace mixrig::scene {
namespace {

template <typename Rung>
std::optional<Rung> read_rung(const config::Table& table, const char* key,
                              const std::vector<std::string>& words) {
  if (!table.has(key)) return std::nullopt;
  return static_cast<Rung>(table.one_of(key, words, 0));
}

/// Notes an error for a key of earlier versions. `instead` is the line of [quality] that replaces
/// it.
void refuse_earlier_key(const config::Table& table, const char* key, const std::string& instead) {
  table.fail(key,
             "is no key of this table any more: remove it, and write " + instead + " in [quality]");
}

/// Refuses the keys that set a quality level before [quality] existed.
void refuse_earlier_keys(const config::Table& root) {
  const config::Table key = root.table("key"), light = root.table("light"),
                      focus = root.table("focus");
  for (const char* earlier : {"color", "refine"}) {
    if (!key.has(earlier)) continue;
    const bool color = key.boolean_or("color", true), refine = key.boolean_or("refine", true);
    refuse_earlier_key(key, earlier,
                       std::string("key = \"") +
                           name(!color   ? KeyRung::kPlain
                                : refine ? KeyRung::kRefined
                                         : KeyRung::kVotes) +
                           "\"");
  }
  if (light.has("people_cast"))
    refuse_earlier_key(
        light, "people_cast",
        light.boolean_or("people_cast", true) ? "light = \"people\"" : "light = \"shadows\"");
  if (focus.has("rung"))
    refuse_earlier_key(
        focus, "rung",
        focus.one_of("rung", {"fine", "fast"}, 0) == 1 ? "focus = \"fast\"" : "focus = \"fine\"");
}

}  // namespace

const char* name(KeyRung rung) {
  return rung == KeyRung::kPlain ? "plain" : rung == KeyRung::kVotes ? "votes" : "refined";
}
const char* name(LightRung rung) {
  return rung == LightRung::kPlain ? "plain" : rung == LightRung::kShadows ? "shadows" : "people";
}
const char* name(FocusRung rung) { return rung == FocusRung::kFast ? "fast" : "fine"; }

Rungs rungs_of(const Scene& scene) {
  Rungs rungs;
  rungs.key = scene.quality.key.value_or(rungs.key);
  const bool has_receiver = !scene.set || scene.set->model;
  rungs.light =
      scene.quality.light.value_or(has_receiver ? LightRung::kPeople : LightRung::kShadows);
  rungs.focus = scene.quality.focus.value_or(rungs.focus);
  return rungs;
}

std::string to_text(const Rungs& rungs, bool has_focus) {
  return std::string("key ") + name(rungs.key) + ", light " + name(rungs.light) +
         (has_focus ? std::string(", focus ") + name(rungs.focus) : "");
}

Quality read_quality(const config::Table& root) {
  const config::Table table = root.table("quality");
  Quality quality;
  quality.key = read_rung<KeyRung>(table, "key", {"plain", "votes", "refined"});
  quality.light = read_rung<LightRung>(table, "light", {"plain", "shadows", "people"});
  quality.focus = read_rung<FocusRung>(table, "focus", {"fast", "fine"});
  if (table.has("budget_ms")) quality.budget_ms = table.number("budget_ms", {0.1, 1000});
  refuse_earlier_keys(root);
  if (quality.focus && !root.table("focus").present())
    table.fail("focus", "the scene has no [focus]: give one, or remove this key");
  return quality;
}

}  // namespace mixrig::scene

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
  const KeySettings& key = scene.key;
  rungs.key = scene.quality.key.value_or(!key.color   ? KeyRung::kPlain
                                         : key.refine ? KeyRung::kRefined
                                                      : KeyRung::kVotes);
  const bool people = scene.set ? scene.set->model.has_value() : scene.light.people_cast;
  rungs.light = scene.quality.light.value_or(people ? LightRung::kPeople : LightRung::kShadows);
  const bool fast = scene.focus && scene.focus->fast;
  rungs.focus = scene.quality.focus.value_or(fast ? FocusRung::kFast : FocusRung::kFine);
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
  if (quality.key && (root.table("key").has("color") || root.table("key").has("refine")))
    table.fail("key", "given beside color or refine of [key]: remove one of them");
  if (quality.light && root.table("light").has("people_cast"))
    table.fail("light", "given beside people_cast of [light]: remove one of them");
  if (quality.focus && !root.table("focus").present())
    table.fail("focus", "the scene has no [focus]: give one, or remove this key");
  if (quality.focus && root.table("focus").has("rung"))
    table.fail("focus", "given beside rung of [focus]: remove one of them");
  return quality;
}

}  // namespace mixrig::scene

// SPDX-License-Identifier: Apache-2.0
// Quality levels ("rungs") of the stages that trade speed against error. Each enumeration goes from
// fast to accurate.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace mixrig::scene {

struct Scene;

/// By depth alone; by colour too; with refined edges.
enum class KeyRung : std::uint8_t { kPlain, kVotes, kRefined };
/// Shadows: none; of objects; of objects and people.
enum class LightRung : std::uint8_t { kPlain, kShadows, kPeople };
enum class FocusRung : std::uint8_t { kFast, kFine };

struct Rungs {
  KeyRung key = KeyRung::kRefined;
  LightRung light = LightRung::kPeople;
  FocusRung focus = FocusRung::kFine;  ///< only used if the scene has a focus
  bool operator==(const Rungs&) const = default;
};

/// Table [quality] of scene.toml. Absent values are those of rungs_of().
struct Quality {
  std::optional<KeyRung> key;
  std::optional<LightRung> light;
  std::optional<FocusRung> focus;
  /// Largest time of a frame: levels are lowered until a frame takes no longer; absent: they are
  /// not lowered.
  std::optional<double> budget_ms;
  bool operator==(const Quality&) const = default;
};

/// Returns the word of scene.toml, such as "votes".
const char* name(KeyRung rung);
const char* name(LightRung rung);
const char* name(FocusRung rung);

/// Returns the quality levels of a scene. A level that it does not state is the best one, except
/// that people cast no shadows in a set without a model. Pure.
Rungs rungs_of(const Scene& scene);
/// Returns text such as "key refined, light people"; with the focus only if there is one.
std::string to_text(const Rungs& rungs, bool has_focus);

}  // namespace mixrig::scene

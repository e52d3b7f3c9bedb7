// SPDX-License-Identifier: Apache-2.0
// Rungs of the stages that trade speed against error, each list from fast to right.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace mixrig::scene {

struct Scene;

enum class KeyRung : std::uint8_t { kPlain, kVotes, kRefined };  ///< depth alone; colour; edges
enum class LightRung : std::uint8_t {
  kPlain,
  kShadows,
  kPeople
};  ///< whose shadows: nobody's,
    ///< objects', and people's
enum class FocusRung : std::uint8_t { kFast, kFine };

struct Rungs {
  KeyRung key = KeyRung::kRefined;
  LightRung light = LightRung::kPeople;
  FocusRung focus = FocusRung::kFine;  ///< only where the scene has a focus
  bool operator==(const Rungs&) const = default;
};

/// [quality] of scene.toml. What is absent is as rungs_of() has it.
struct Quality {
  std::optional<KeyRung> key;
  std::optional<LightRung> light;
  std::optional<FocusRung> focus;
  /// Rungs are left until a frame takes no longer; absent: they stay.
  std::optional<double> budget_ms;
  bool operator==(const Quality&) const = default;
};

/// The words of scene.toml: "votes".
const char* name(KeyRung rung);
const char* name(LightRung rung);
const char* name(FocusRung rung);

/// Rungs that a scene asks for; what it does not say is the best one, but that people cast no
/// shadows in a set without a model. Pure.
Rungs rungs_of(const Scene& scene);
/// "key refined, light people"; the focus only where there is one.
std::string to_text(const Rungs& rungs, bool has_focus);

}  // namespace mixrig::scene

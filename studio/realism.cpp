// SPDX-License-Identifier: Apache-2.0
// Names of the switches of realism.
#include "studio/realism.h"

#include <array>

#include <fmt/format.h>

namespace mixrig::studio {
namespace {

constexpr std::array<NamedSwitch, 18> kSwitches{{{"mosaic", &Realism::mosaic},
                                                 {"chroma", &Realism::chroma},
                                                 {"gain-drift", &Realism::gain_drift},
                                                 {"vignetting", &Realism::vignetting},
                                                 {"motion-blur", &Realism::motion_blur},
                                                 {"rolling-shutter", &Realism::rolling_shutter},
                                                 {"defocus", &Realism::defocus},
                                                 {"multipath", &Realism::multipath},
                                                 {"stray-light", &Realism::stray_light},
                                                 {"pixel-offsets", &Realism::pixel_offsets},
                                                 {"warm-up", &Realism::warm_up},
                                                 {"harmonics", &Realism::harmonics},
                                                 {"late-depth", &Realism::late_depth},
                                                 {"bounce", &Realism::bounce},
                                                 {"gloss", &Realism::gloss},
                                                 {"mirror", &Realism::mirror},
                                                 {"hair", &Realism::hair},
                                                 {"loose-clothes", &Realism::loose_clothes}}};

}  // namespace

std::span<const NamedSwitch> realism_switches() { return kSwitches; }

Realism Realism::all() {
  Realism realism;
  for (const NamedSwitch& s : kSwitches) realism.*s.on = true;
  return realism;
}

Result<Realism> parse_realism(std::string_view list) {
  Realism realism;
  while (!list.empty()) {
    const std::size_t comma = std::min(list.find(','), list.size());
    const std::string_view word = list.substr(0, comma);
    list.remove_prefix(std::min(comma + 1, list.size()));
    bool known = false;
    for (const NamedSwitch& s : kSwitches)
      if (s.name == word) realism.*s.on = known = true;
    if (!known)
      return Error{ErrorCode::kUsage,
                   fmt::format("unknown switch of realism '{}': use some of {}, with commas", word,
                               names_of(Realism::all()))};
  }
  return realism;
}

Realism minus(Realism from, const Realism& without) {
  for (const NamedSwitch& s : kSwitches)
    if (without.*s.on) from.*s.on = false;
  return from;
}

std::string names_of(const Realism& realism) {
  std::string names;
  for (const NamedSwitch& s : kSwitches)
    if (realism.*s.on) names += (names.empty() ? "" : ",") + std::string(s.name);
  return names.empty() ? "plain" : names;
}

}  // namespace mixrig::studio

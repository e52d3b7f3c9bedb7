// SPDX-License-Identifier: Apache-2.0
// What the viewfinder shows, and what its keys change. Pure.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "hal/base/clock.h"
#include "host/output/sink/run_orders.h"
#include "host/output/viewfinder/picture.h"

namespace mixrig::viewfinder {

enum class Overlay : std::uint8_t {
  kRate,
  kDelay,
  kSync,
  kPose,
  kZebra,
  kPeaking,
  kGuides,
  kHelp,
  kCount
};
inline constexpr std::size_t kOverlays = static_cast<std::size_t>(Overlay::kCount);

/// What a key asks of the run rather than of the picture.
enum class Request : std::uint8_t { kNone, kLearn, kRecord, kPlace, kQuit, kFullScreen };

struct ViewState {
  View view = View::kComposite;
  /// Warnings of a lost pose are on from the start; nothing covers the picture otherwise.
  std::array<bool, kOverlays> overlays{false, false, false, true};
  bool frozen = false;
  std::uint32_t placements = 0;  ///< as RunState::placements, told on the screen

  bool on(Overlay overlay) const { return overlays[static_cast<std::size_t>(overlay)]; }
};

/// A key and what it does, for the help and the documentation.
struct KeyHelp {
  char key;
  std::string_view what;
};
inline constexpr char kEscape = 27, kFullScreenKey = '\n';
inline constexpr std::array<KeyHelp, 20> kKeys{{{'1', "composite"},
                                                {'2', "plate"},
                                                {'3', "key states"},
                                                {'4', "depth, colours rescaled"},
                                                {'5', "light map"},
                                                {'6', "matte"},
                                                {'f', "pictures per second"},
                                                {'d', "delay"},
                                                {'s', "state of the cameras"},
                                                {'p', "warning of a lost pose"},
                                                {'z', "zebra: overexposed"},
                                                {'x', "focus peaking"},
                                                {'g', "frame guides"},
                                                {'h', "this help"},
                                                {' ', "freeze"},
                                                {'b', "accept room changes"},
                                                {'r', "record, stop or pause"},
                                                {'o', "place the next object"},
                                                {kFullScreenKey, "full screen"},
                                                {'q', "quit (also Esc)"}}};

/// Changes the state by a key (lower case, or kEscape); other keys do nothing. Gives what it asks
/// of the run.
Request press(char key, ViewState& state);

/// What others than the keys have changed.
struct RunNews {
  bool view = false, frozen = false;
  std::optional<output::Placement> placed;  ///< of the last order to place that was obeyed

  bool any() const { return view || frozen || placed; }
};
/// Takes over what the run tells; each thing is news once.
RunNews follow(const output::RunState& run, ViewState& state);

/// How new a picture is.
enum class Freshness : std::uint8_t {
  kLive,
  kStale,  ///< the last picture, with its age written over it
  kGone,   ///< a placeholder: too old to be shown
};
inline constexpr Duration kStaleAfter = std::chrono::milliseconds(300);
inline constexpr Duration kGoneAfter = std::chrono::seconds(5);

/// From the time since the last picture came. Stale after kStaleAfter or three frame periods of a
/// source of `rate_hz` (0: unknown), whichever is longer; gone after kGoneAfter.
Freshness freshness(Duration since_last, double rate_hz);

}  // namespace mixrig::viewfinder

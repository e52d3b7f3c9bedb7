// SPDX-License-Identifier: Apache-2.0
// State of the viewfinder's display, and how keys change it. Pure.
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

/// What a key asks of the run; kNone: it only changes the display.
enum class Request : std::uint8_t { kNone, kLearn, kRecord, kPlace, kLeave, kQuit, kFullScreen };

struct ViewState {
  View view = View::kComposite;
  /// The warning of a lost pose is on at the start; nothing else covers the picture.
  std::array<bool, kOverlays> overlays{false, false, false, true};
  bool frozen = false;
  std::uint32_t placements = 0;  ///< RunState::placements that have been announced on the screen

  bool on(Overlay overlay) const { return overlays[static_cast<std::size_t>(overlay)]; }
};

/// A key and its action, for the help and the documentation.
struct KeyHelp {
  char key;
  std::string_view what;
};
inline constexpr char kEscape = 27, kWindowClosed = 4, kFullScreenKey = '\n';
inline constexpr std::array<KeyHelp, 21> kKeys{{{'1', "composite"},
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
                                                {kEscape, "leave full screen, quit"},
                                                {'q', "quit"}}};

/// Changes the state by a key (one of kKeys, or kWindowClosed); other keys do nothing. Returns what
/// the key asks of the run.
Request press(char key, ViewState& state);

/// Changes to the display that come from elsewhere than its keys.
struct RunNews {
  bool view = false, frozen = false;
  std::optional<output::Placement> placed;  ///< result of the last handled order to place an object

  bool any() const { return view || frozen || placed; }
};
/// Takes over the run's state; reports each change once.
RunNews follow(const output::RunState& run, ViewState& state);

/// How recent a picture is.
enum class Freshness : std::uint8_t {
  kLive,
  kStale,  ///< the last picture, with its age written over it
  kGone,   ///< too old: a placeholder is shown
};
inline constexpr Duration kStaleAfter = std::chrono::milliseconds(300);
inline constexpr Duration kGoneAfter = std::chrono::seconds(5);

/// Freshness by the time since the last picture came. Stale after kStaleAfter or three frame
/// periods at `rate_hz` (0: unknown), whichever is longer; gone after kGoneAfter.
Freshness freshness(Duration since_last, double rate_hz);

}  // namespace mixrig::viewfinder

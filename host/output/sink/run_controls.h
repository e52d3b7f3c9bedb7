// SPDX-License-Identifier: Apache-2.0
// What an operator asks of a run while it runs: by keys, by signals, by a page, by OSC. There is
// one for a run, so that each of them shows what the others have changed.
#pragma once

#include <atomic>

#include "host/output/sink/views.h"

namespace mixrig::output {

/// Any threads. It must outlive the run and its sinks.
struct RunControls {
  std::atomic<bool>& stop;  ///< true: the run ends with the frames done so far
  std::atomic<int>& learn;  ///< one more: what changed in the room becomes background
  /// Of the pictures that are shown, not of what is written.
  std::atomic<View> view = View::kComposite;
  std::atomic<bool> frozen = false;  ///< the pictures that are shown stay as they are
  /// False: frames are not written to the run's files. With `records_takes` instead: whether a take
  /// is being recorded; a change of it begins or ends one.
  std::atomic<bool> recording = true;
  bool records_takes = false;  ///< set before the run begins
  /// Looks at the empty room that are still to be taken before it replaces the background; 0: none.
  /// kScanLooks begins, 0 ends without a result.
  std::atomic<int> scan_left = 0;
  static constexpr int kScanLooks = 24;
  /// Pixel of the view whose depth is sharp from now on, x + 65536 y; below 0: as the scene says.
  std::atomic<int> focus_at = -1;
  /// Object, counted from 0, that is to be set on the surface at `place_at`, a pixel as focus_at;
  /// `place_at` below 0: none, the last one was set or refused.
  std::atomic<int> place_object = 0, place_at = -1;
  /// What became of it, for the screen: a text that is never freed; null: nothing new.
  std::atomic<const char*> place_said = nullptr;
  // Told by the run, once it has begun:
  std::atomic<int> objects = 0;          ///< that can be placed
  std::atomic<bool> can_learn = false;   ///< the background is watched
  std::atomic<bool> can_scan = false;    ///< it is of one view, which can be learned anew
  std::atomic<bool> can_record = false;  ///< there is a folder to write to
  std::atomic<bool> can_focus = false;   ///< the scene has a [focus]
};

}  // namespace mixrig::output

// SPDX-License-Identifier: Apache-2.0
// What an operator asks of a run while it runs: by keys, by signals, by a page.
#pragma once

#include <atomic>

namespace mixrig::output {

/// Any threads. It must outlive the run and its sinks.
struct RunControls {
  std::atomic<bool>& stop;             ///< true: the run ends with the frames done so far
  std::atomic<int>& learn;             ///< one more: what changed in the room becomes background
  std::atomic<bool> recording = true;  ///< false: frames are not written to files
  /// Pixel of the view whose depth is sharp from now on, x + 65536 y; below 0: as the scene says.
  std::atomic<int> focus_at = -1;
  // Told by the run, once it has begun:
  std::atomic<bool> can_learn = false;   ///< the background is watched
  std::atomic<bool> can_record = false;  ///< there is a folder to write to
  std::atomic<bool> can_focus = false;   ///< the scene has a [focus]
};

}  // namespace mixrig::output

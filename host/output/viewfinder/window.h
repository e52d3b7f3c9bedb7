// SPDX-License-Identifier: Apache-2.0
// A window on a desktop, or the whole screen of a board, by SDL.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hal/base/image.h"
#include "hal/base/result.h"
#include "host/output/viewfinder/screen.h"
#include "host/render/contract/compositor.h"

namespace mixrig::viewfinder {

/// Keys that were pressed: lower case, kFullScreenKey, kEscape; kWindowClosed for its close button.
using Keys = std::vector<char>;

/// All calls must come from the thread that opened it. At most one a process.
class Window {
 public:
  /// Opens full screen if there is no desktop (SDL's driver KMSDRM), else in the picture's size or
  /// as large as the desktop allows. The driver is SDL's choice (Wayland, X11, KMSDRM) or that of
  /// SDL_VIDEODRIVER. With `shares`, SDL draws by OpenGL ES if it can. Errors: kDevice if no driver
  /// can show anything.
  static Result<std::unique_ptr<Window>> open(const std::string& title, Size picture, bool shares);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Handles events since the last call; returns the keys that were pressed.
  const Keys& poll();
  /// Pixel of the picture that was clicked, between the last poll() and the one before; nullopt:
  /// none.
  struct Click {
    int x = 0, y = 0;
  };
  std::optional<Click> click() const;
  /// False without a desktop, where the window is the whole screen.
  bool can_leave_full_screen() const;
  void toggle_full_screen();
  /// The context with which a compositor can share objects; empty if SDL does not draw by OpenGL
  /// ES.
  render::GlShare share() const;
  /// Shows a picture of any size as large as it fits, with black borders. The picture below it is
  /// copied only if it `is_new`. Errors: kDevice.
  Result<void> show(const Drawn& drawn, bool is_new);
  /// SDL's driver and renderer, such as "x11, software".
  std::string driver() const;

 private:
  struct State;
  struct Layer;
  Result<void> fit(Layer& layer, Size size);
  explicit Window(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace mixrig::viewfinder

// SPDX-License-Identifier: Apache-2.0
// A window on a desktop, or the whole screen of a board: what SDL is used for.
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

/// What happened to a window: keys in lower case, kEscape also where it was closed, kFullScreenKey.
using Keys = std::vector<char>;

/// All calls come from the thread that opened it. One at a time in a process.
class Window {
 public:
  /// Full screen where there is no desktop (SDL's driver KMSDRM), else of the picture's size or as
  /// large as the desktop has room for. The driver is SDL's choice (Wayland, X11, KMSDRM) or that
  /// of SDL_VIDEODRIVER. With `shares`, SDL draws by OpenGL ES where it can. Errors: kDevice where
  /// no driver can show anything.
  static Result<std::unique_ptr<Window>> open(const std::string& title, Size picture, bool shares);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Handles what has happened since the last call; the keys that were pressed.
  const Keys& poll();
  /// Pixel of the picture that was clicked before the last poll() and after the one before;
  /// nothing: none.
  struct Click {
    int x = 0, y = 0;
  };
  std::optional<Click> click() const;
  void toggle_full_screen();
  /// The context that a compositor can share objects with; empty where SDL draws otherwise.
  render::GlShare share() const;
  /// Shows a picture of any size, as large as it fits, with black borders. What lies below is
  /// copied only if it `is_new`. Errors: kDevice.
  Result<void> show(const Drawn& drawn, bool is_new);
  /// "x11, software": SDL's driver and renderer.
  std::string driver() const;

 private:
  struct State;
  struct Layer;
  Result<void> fit(Layer& layer, Size size);
  explicit Window(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace mixrig::viewfinder

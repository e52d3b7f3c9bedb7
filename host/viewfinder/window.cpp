// SPDX-License-Identifier: Apache-2.0
#include "host/viewfinder/window.h"

#include <algorithm>
#include <cstdlib>
#include <string_view>

#include <SDL.h>

#include "host/viewfinder/view_state.h"

namespace mixrig::viewfinder {
namespace {

Error sdl_error(const std::string& what) {
  return {ErrorCode::kDevice, "viewfinder: " + what + " (SDL: " + SDL_GetError() + ")"};
}

std::string_view video_driver() {
  const char* const name = SDL_GetCurrentVideoDriver();
  return name != nullptr ? name : "";
}

bool whole_screen() { return video_driver() == "KMSDRM"; }

/// SDL falls back to drivers that show nothing.
bool shows_nothing() {
  if (std::getenv("SDL_VIDEODRIVER") != nullptr) return false;  // they were asked for
  const std::string_view driver = video_driver();
  return driver == "offscreen" || driver == "dummy" || driver == "evdev";
}

Size window_size(Size picture) {
  SDL_Rect room{};
  if (SDL_GetDisplayUsableBounds(0, &room) != 0 || room.w <= 0 || room.h <= 0) return picture;
  const double scale = std::min({1.0, static_cast<double>(room.w) / std::max(picture.width, 1),
                                 static_cast<double>(room.h) / std::max(picture.height, 1)});
  return {std::max(1, static_cast<int>(picture.width * scale)),
          std::max(1, static_cast<int>(picture.height * scale))};
}

char key_of(SDL_Keycode code) {
  if (code == SDLK_ESCAPE) return kEscape;
  if (code == SDLK_RETURN || code == SDLK_KP_ENTER) return kFullScreenKey;
  if (code >= SDLK_KP_1 && code <= SDLK_KP_9) return static_cast<char>('1' + code - SDLK_KP_1);
  return code > 0 && code < 127 ? static_cast<char>(code) : '\0';
}

}  // namespace

struct Window::State {
  SDL_Window* window = nullptr;
  SDL_Renderer* renderer = nullptr;
  SDL_Texture* texture = nullptr;
  Size texture_px;
  Keys keys;
  std::optional<Window::Click> click;

  State() { keys.reserve(64); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (texture != nullptr) SDL_DestroyTexture(texture);
    if (renderer != nullptr) SDL_DestroyRenderer(renderer);
    if (window != nullptr) SDL_DestroyWindow(window);
    SDL_QuitSubSystem(SDL_INIT_VIDEO);
  }
};

Window::Window(std::unique_ptr<State> state) : state_(std::move(state)) {}
Window::~Window() = default;

Result<std::unique_ptr<Window>> Window::open(const std::string& title, Size picture) {
  SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");  // Ctrl-C is the command's
  SDL_SetHint(SDL_HINT_RENDER_SCALE_QUALITY, "linear");
  if (SDL_InitSubSystem(SDL_INIT_VIDEO) != 0)
    return sdl_error(
        "there is no screen to show it on: set DISPLAY or WAYLAND_DISPLAY, or on a "
        "board without a desktop be in the groups video, render and input");
  auto state = std::make_unique<State>();
  if (shows_nothing())
    return Error{ErrorCode::kDevice,
                 "viewfinder: there is no screen to show it on: set DISPLAY or WAYLAND_DISPLAY, or "
                 "on a board without a desktop be in the groups video, render and input"};
  const Size size = window_size(picture);
  const Uint32 flags = whole_screen() ? SDL_WINDOW_FULLSCREEN_DESKTOP : SDL_WINDOW_RESIZABLE;
  state->window = SDL_CreateWindow(title.c_str(), SDL_WINDOWPOS_CENTERED, SDL_WINDOWPOS_CENTERED,
                                   size.width, size.height, flags);
  if (state->window == nullptr) return sdl_error("no window could be opened");
  state->renderer = SDL_CreateRenderer(state->window, -1, 0);
  if (state->renderer == nullptr) return sdl_error("nothing can be drawn in the window");
  if (whole_screen()) SDL_ShowCursor(SDL_DISABLE);
  return std::unique_ptr<Window>(new Window(std::move(state)));
}

const Keys& Window::poll() {
  Keys& keys = state_->keys;
  keys.clear();
  state_->click.reset();
  SDL_Event event;
  while (SDL_PollEvent(&event) != 0) {
    if (keys.size() == keys.capacity()) break;  // the rest next time
    const bool closed = event.type == SDL_QUIT || (event.type == SDL_WINDOWEVENT &&
                                                   event.window.event == SDL_WINDOWEVENT_CLOSE);
    if (closed) keys.push_back(kEscape);
    if (event.type == SDL_MOUSEBUTTONDOWN && event.button.button == SDL_BUTTON_LEFT)
      state_->click = Click{event.button.x, event.button.y};
    if (event.type == SDL_KEYDOWN && event.key.repeat == 0)
      if (const char key = key_of(event.key.keysym.sym); key != '\0') keys.push_back(key);
  }
  return keys;
}

std::optional<Window::Click> Window::click() const { return state_->click; }

void Window::toggle_full_screen() {
  if (whole_screen()) return;
  const bool is = (SDL_GetWindowFlags(state_->window) & SDL_WINDOW_FULLSCREEN_DESKTOP) != 0;
  SDL_SetWindowFullscreen(state_->window, is ? 0 : SDL_WINDOW_FULLSCREEN_DESKTOP);
}

Result<void> Window::show(ImageView<const Rgbx8> picture) {
  State& s = *state_;
  if (s.texture == nullptr || s.texture_px != picture.size) {
    if (s.texture != nullptr) SDL_DestroyTexture(s.texture);
    s.texture = SDL_CreateTexture(s.renderer, SDL_PIXELFORMAT_XBGR8888, SDL_TEXTUREACCESS_STREAMING,
                                  picture.size.width, picture.size.height);
    if (s.texture == nullptr) return sdl_error("the picture is too large for the screen");
    s.texture_px = picture.size;
    SDL_RenderSetLogicalSize(s.renderer, picture.size.width, picture.size.height);
  }
  const int pitch = static_cast<int>(picture.stride * static_cast<std::ptrdiff_t>(sizeof(Rgbx8)));
  SDL_SetRenderDrawColor(s.renderer, 0, 0, 0, 255);
  if (SDL_UpdateTexture(s.texture, nullptr, picture.data, pitch) != 0 ||
      SDL_RenderClear(s.renderer) != 0 ||
      SDL_RenderCopy(s.renderer, s.texture, nullptr, nullptr) != 0)
    return sdl_error("the picture could not be shown");
  SDL_RenderPresent(s.renderer);
  return {};
}

std::string Window::driver() const {
  SDL_RendererInfo info{};
  const bool known = SDL_GetRendererInfo(state_->renderer, &info) == 0;
  return std::string(video_driver()) + ", " + (known ? info.name : "unknown renderer");
}

}  // namespace mixrig::viewfinder

// SPDX-License-Identifier: Apache-2.0
#include "host/output/viewfinder/window.h"

#include <algorithm>
#include <cstdlib>
#include <string_view>

#include <EGL/egl.h>
#include <GLES3/gl31.h>
#include <SDL.h>

#include "host/output/viewfinder/view_state.h"

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

/// Whether SDL has fallen back to a driver that shows nothing.
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

/// A picture in the window.
struct Window::Layer {
  explicit Layer(SDL_BlendMode mode) : blend(mode) {}
  Layer(const Layer&) = delete;
  Layer& operator=(const Layer&) = delete;
  ~Layer() { drop(); }
  void drop() {
    if (texture != nullptr) SDL_DestroyTexture(texture);
    texture = nullptr;
  }
  const SDL_BlendMode blend;
  SDL_Texture* texture = nullptr;
  Size px;
};

struct Window::State {
  SDL_Window* window = nullptr;
  SDL_Renderer* renderer = nullptr;
  Layer whole{SDL_BLENDMODE_NONE};  ///< a picture that is all, or lies below
  /// Colours are multiplied by their share already.
  Layer over{SDL_ComposeCustomBlendMode(
      SDL_BLENDFACTOR_ONE, SDL_BLENDFACTOR_ONE_MINUS_SRC_ALPHA, SDL_BLENDOPERATION_ADD,
      SDL_BLENDFACTOR_ONE, SDL_BLENDFACTOR_ONE_MINUS_SRC_ALPHA, SDL_BLENDOPERATION_ADD)};
  Keys keys;
  std::optional<Window::Click> click;

  State() { keys.reserve(64); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    whole.drop(), over.drop();  // before their renderer
    if (renderer != nullptr) SDL_DestroyRenderer(renderer);
    if (window != nullptr) SDL_DestroyWindow(window);
    SDL_QuitSubSystem(SDL_INIT_VIDEO);
  }
};

Window::Window(std::unique_ptr<State> state) : state_(std::move(state)) {}
Window::~Window() = default;

Result<std::unique_ptr<Window>> Window::open(const std::string& title, Size picture, bool shares) {
  SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");  // Ctrl-C is the command's
  SDL_SetHint(SDL_HINT_RENDER_SCALE_QUALITY, "linear");
  if (shares) {
    SDL_SetHint(SDL_HINT_VIDEO_X11_FORCE_EGL, "1");
    SDL_SetHint(SDL_HINT_RENDER_DRIVER, "opengles2");  // SDL_RENDER_DRIVER is stronger
  }
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
    if (closed) keys.push_back(kWindowClosed);
    if (event.type == SDL_MOUSEBUTTONDOWN && event.button.button == SDL_BUTTON_LEFT)
      state_->click = Click{event.button.x, event.button.y};
    if (event.type == SDL_KEYDOWN && event.key.repeat == 0)
      if (const char key = key_of(event.key.keysym.sym); key != '\0') keys.push_back(key);
  }
  return keys;
}

std::optional<Window::Click> Window::click() const { return state_->click; }

bool Window::can_leave_full_screen() const {
  return !whole_screen() &&
         (SDL_GetWindowFlags(state_->window) & SDL_WINDOW_FULLSCREEN_DESKTOP) != 0;
}

void Window::toggle_full_screen() {
  if (whole_screen()) return;
  SDL_SetWindowFullscreen(state_->window,
                          can_leave_full_screen() ? 0 : SDL_WINDOW_FULLSCREEN_DESKTOP);
}

render::GlShare Window::share() const {
  SDL_RendererInfo info{};
  if (SDL_GetRendererInfo(state_->renderer, &info) != 0 ||
      std::string_view(info.name) != "opengles2" || eglGetCurrentContext() == EGL_NO_CONTEXT)
    return {};
  GLint major = 0;
  glGetIntegerv(GL_MAJOR_VERSION, &major);
  if (major < 3) return {};
  return {eglGetCurrentDisplay(), eglGetCurrentContext()};
}

Result<void> Window::fit(Layer& layer, Size size) {
  if (layer.texture != nullptr && layer.px == size) return {};
  layer.drop();
  SDL_Renderer* const renderer = state_->renderer;
  layer.texture = SDL_CreateTexture(renderer, SDL_PIXELFORMAT_ABGR8888, SDL_TEXTUREACCESS_STREAMING,
                                    size.width, size.height);
  if (layer.texture == nullptr) return sdl_error("the picture is too large for the screen");
  layer.px = size;
  SDL_SetTextureBlendMode(layer.texture, layer.blend);
  SDL_RenderSetLogicalSize(renderer, size.width, size.height);
  return {};
}

Result<void> Window::show(const Drawn& drawn, bool is_new) {
  State& s = *state_;
  const ImageView<const Rgbx8>& picture = drawn.picture;
  const int pitch = static_cast<int>(picture.stride * static_cast<std::ptrdiff_t>(sizeof(Rgbx8)));
  Layer& own = drawn.below != nullptr ? s.over : s.whole;
  bool fine = true;
  if (drawn.below != nullptr) {
    MIXRIG_TRY(fit(s.whole, drawn.below->size_px()));
    if (is_new) {
      SDL_RenderFlush(s.renderer);
      fine = SDL_GL_BindTexture(s.whole.texture, nullptr, nullptr) == 0;
      if (fine) MIXRIG_TRY(drawn.below->copy_to_bound_texture());
      SDL_GL_UnbindTexture(s.whole.texture);
    }
  }
  if (!drawn.is_empty) {
    MIXRIG_TRY(fit(own, picture.size));
    fine = fine && SDL_UpdateTexture(own.texture, nullptr, picture.data, pitch) == 0;
  }
  SDL_SetRenderDrawColor(s.renderer, 0, 0, 0, 255);
  fine = fine && SDL_RenderClear(s.renderer) == 0 &&
         SDL_RenderCopy(s.renderer, s.whole.texture, nullptr, nullptr) == 0;
  if (drawn.below != nullptr && !drawn.is_empty)
    fine = fine && SDL_RenderCopy(s.renderer, s.over.texture, nullptr, nullptr) == 0;
  if (!fine) return sdl_error("the picture could not be shown");
  SDL_RenderPresent(s.renderer);
  return {};
}

std::string Window::driver() const {
  SDL_RendererInfo info{};
  const bool known = SDL_GetRendererInfo(state_->renderer, &info) == 0;
  return std::string(video_driver()) + ", " + (known ? info.name : "unknown renderer");
}

}  // namespace mixrig::viewfinder

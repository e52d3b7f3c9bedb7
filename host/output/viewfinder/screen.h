// SPDX-License-Identifier: Apache-2.0
// Draws the viewfinder's whole picture: a view of a composite with text and marks over it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "hal/base/clock.h"
#include "hal/base/image.h"
#include "host/output/sink/composite_sink.h"
#include "host/output/viewfinder/text_line.h"
#include "host/output/viewfinder/view_state.h"

namespace mixrig::viewfinder {

/// Facts shown beside the composite.
struct ScreenFacts {
  bool live = false;                      ///< the source is devices, whose pictures have an age
  double rate_hz = 0;                     ///< rate of the source; 0: unknown
  double shown_hz = 0;                    ///< pictures shown in the last second
  Duration since_last{};                  ///< time since the last picture came
  std::optional<Duration> age;            ///< of a live picture: time since its mid-exposure
  std::optional<Duration> delay;          ///< of a live picture: mid-exposure to being shown
  std::optional<Duration> without_depth;  ///< time since depth was lost
  bool recording = false;
  TextLine message;  ///< answer to a key; empty: none
  TextLine fault;    ///< names the lost device; empty: none
  static constexpr std::size_t kSyncLines = 8;
  std::array<TextLine, kSyncLines> sync;  ///< for streams and sets; empty ones are not shown
};

/// What a window shows.
struct Drawn {
  ImageView<const Rgbx8> picture;  ///< the fourth byte is the share that covers `below`
  /// A composite in GPU memory that lies under `picture`; null: `picture` is everything.
  const render::GpuPicture* below = nullptr;
  bool is_empty = false;  ///< nothing covers `below`
};

/// Draws into a picture that it owns. Not thread-safe. Allocates only when the size changes, and
/// when the range of depth colours is set.
class Screen {
 public:
  /// Draws the screen. `composite` may be null if none has come yet. The range of depth colours is
  /// set by the first picture drawn after forget_range().
  Drawn draw(const output::Composite* composite, const ViewState& state, const ScreenFacts& facts);
  void forget_range() { range_.reset(); }

 private:
  /// Draws the view; returns the GPU picture that lies below, or null if everything was drawn here.
  const render::GpuPicture* draw_picture(const output::Composite* composite, const ViewState& state,
                                         bool gone);
  const render::GpuPicture* clear_over_gpu(const output::Composite& composite, View view);
  void write_banner(const output::Composite* composite, const ViewState& state,
                    const ScreenFacts& facts);
  void write_warnings(const output::Composite* composite, const ViewState& state,
                      const ScreenFacts& facts);
  void write_corner(const ViewState& state, const ScreenFacts& facts);
  void write_help();
  void line(int x, int& y, std::string_view text, Rgb8 ink);
  void centred(int y, std::string_view text, int scale, Rgb8 ink);
  int scale() const;

  Image<Rgbx8> picture_;
  bool is_clear_ = false;  ///< nothing was drawn over the picture below
  std::optional<DepthColors> range_;
};

}  // namespace mixrig::viewfinder

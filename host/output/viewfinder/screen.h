// SPDX-License-Identifier: Apache-2.0
// A whole picture of the viewfinder: a view of a composite and what is written over it.
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

/// What is known beside the composite.
struct ScreenFacts {
  bool live = false;              ///< of devices: pictures have an age since their exposure
  double rate_hz = 0;             ///< of the source; 0: unknown
  double shown_hz = 0;            ///< pictures shown in the last second
  Duration since_last{};          ///< since the last picture came
  std::optional<Duration> age;    ///< since the mid-exposure of the picture, of a live source
  std::optional<Duration> delay;  ///< of a live picture: mid-exposure to being shown
  std::optional<Duration> without_depth;  ///< for how long
  bool recording = false;
  TextLine message;  ///< answer to a key; empty: none
  TextLine fault;    ///< the device that is lost; empty: none
  static constexpr std::size_t kSyncLines = 8;
  std::array<TextLine, kSyncLines> sync;  ///< of streams and sets; empty ones are left out
};

/// What a window shows.
struct Drawn {
  ImageView<const Rgbx8> picture;  ///< the fourth byte is the share that covers `below`
  /// The composite that stays in the GPU's memory, under `picture`; null: `picture` is all.
  const render::GpuPicture* below = nullptr;
  bool is_empty = false;  ///< nothing is drawn over `below`
};

/// Draws into a picture that it keeps. Not thread-safe. Allocates only when the size changes, and
/// for the range of depth colours when it is set.
class Screen {
 public:
  /// `composite` may be null: nothing has come yet. The range of depth colours is that of the
  /// first picture drawn after forget_range().
  Drawn draw(const output::Composite* composite, const ViewState& state, const ScreenFacts& facts);
  void forget_range() { range_.reset(); }

 private:
  /// What lies below; null where all of it was drawn here.
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
  bool is_clear_ = false;  ///< nothing was drawn over what lies below
  std::optional<DepthColors> range_;
};

}  // namespace mixrig::viewfinder

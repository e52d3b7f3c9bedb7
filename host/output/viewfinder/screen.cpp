// SPDX-License-Identifier: Apache-2.0
#include "host/output/viewfinder/screen.h"

#include <algorithm>
#include <cctype>

#include "host/capture/capture/capture.h"
#include "host/capture/capture/pose_source.h"
#include "host/output/report/picture.h"
#include "host/output/viewfinder/font.h"
#include "host/output/viewfinder/marks.h"

namespace mixrig::viewfinder {
namespace {

constexpr Size kWithoutPicture{640, 360};
constexpr Rgb8 kInk{240, 240, 240}, kWarning{255, 210, 60}, kAlarm{255, 90, 70},
    kRecording{255, 60, 60};
constexpr int kScreenLines = 32;  ///< of text, that a picture holds below one another

bool missing(const output::Composite& composite, capture::Stream stream) {
  return composite.capture->status_of(stream) == capture::StreamStatus::kMissing;
}

}  // namespace

int Screen::scale() const {
  return std::max(1, picture_.height() / (kScreenLines * (kGlyphHeight_px + 1)));
}

void Screen::line(int x, int& y, std::string_view text, Rgb8 ink) {
  if (text.empty()) return;
  is_clear_ = false;
  const int s = scale();
  const Size size = text_size(text, s);
  darken(picture_, x - s, y - s, {size.width + 2 * s, size.height + 2 * s});
  draw_text(picture_, x, y, text, s, ink);
  y += size.height + 2 * s;
}

/// Writes a text in the middle, in the largest size up to `scale` that fits.
void Screen::centred(int y, std::string_view text, int scale, Rgb8 ink) {
  is_clear_ = false;
  while (scale > 1 && text_size(text, scale).width + 2 * scale > picture_.width()) --scale;
  const Size size = text_size(text, scale);
  const int x = (picture_.width() - size.width) / 2;
  for (int i = 0; i < 2; ++i)
    darken(picture_, x - 2 * scale, y - 2 * scale,
           {size.width + 4 * scale, size.height + 4 * scale});
  draw_text(picture_, x, y, text, scale, ink);
}

/// Clears the picture over a composite that is in GPU memory only, and returns that; null, with
/// nothing changed, where it was read back or is not the view.
const render::GpuPicture* Screen::clear_over_gpu(const output::Composite& composite, View view) {
  const render::FrameOutput& images = composite.images;
  const bool only_there = images.gpu_color != nullptr && (images.wanted & render::kColor) == 0;
  if (view != View::kComposite || !only_there) return nullptr;
  const Size size = images.gpu_color->size_px();
  if (picture_.size() != size) picture_.reset(size);
  picture_.fill(Rgbx8{0, 0, 0, 0});
  is_clear_ = true;
  return images.gpu_color.get();
}

const render::GpuPicture* Screen::draw_picture(const output::Composite* composite,
                                               const ViewState& state, bool gone) {
  is_clear_ = false;
  if (composite == nullptr || gone) {
    if (picture_.empty()) picture_.reset(kWithoutPicture);
    draw_placeholder(picture_);
    return nullptr;
  }
  if (const render::GpuPicture* below = clear_over_gpu(*composite, state.view)) {
    if (state.on(Overlay::kGuides)) draw_guides(picture_), is_clear_ = false;
    return below;
  }
  const render::FrameOutput& images = composite->images;
  if (state.view == View::kDepth && !range_ && (images.wanted & render::kMixedDepth) != 0) {
    const auto [near_m, far_m] = report::depth_range(images.mixed_depth_m);
    range_ = DepthColors{near_m, far_m};
  }
  if (!draw_view(*composite, state.view, range_.value_or(DepthColors()), picture_)) {
    if (picture_.empty()) picture_.reset(kWithoutPicture);
    draw_placeholder(picture_);
    TextLine words;
    words.set("no {} in this frame", name(state.view));
    centred(picture_.height() / 2, words.view(), 2 * scale(), kInk);
    return nullptr;
  }
  const bool of_camera = state.view == View::kComposite || state.view == View::kPlate;
  mark_exposure_and_focus(picture_, of_camera && state.on(Overlay::kZebra),
                          of_camera && state.on(Overlay::kPeaking));
  if (state.on(Overlay::kGuides)) draw_guides(picture_);
  return nullptr;
}

/// Writes in the middle that the picture is not live; it cannot be switched off.
void Screen::write_banner(const output::Composite* composite, const ViewState& state,
                          const ScreenFacts& facts) {
  const int s = scale(), y = picture_.height() / 2 - 12 * s;
  const Freshness fresh = freshness(facts.since_last, facts.rate_hz);
  TextLine words;
  Rgb8 ink = kAlarm;
  if (composite == nullptr) {
    words.set("waiting for the first picture");
    ink = kInk;
  } else if (fresh == Freshness::kGone) {
    words.set("NO PICTURE FOR {:.0f} s", seconds(facts.since_last));
  } else if (fresh == Freshness::kStale) {
    words.set("LAST PICTURE, {:.1f} s OLD", seconds(facts.age.value_or(facts.since_last)));
  } else if (state.frozen) {
    words.set("FROZEN");
    if (facts.age) words.set("FROZEN, {:.1f} s OLD", seconds(*facts.age));
    ink = kWarning;
  }
  if (words.empty()) return;
  draw_border(picture_, 3 * s, ink);
  centred(y, words.view(), 3 * s, ink);
  if (!facts.fault.empty() && fresh != Freshness::kLive)
    centred(y + 28 * s, facts.fault.view(), s, kInk);
}

/// Writes faults of the shown frame along the top.
void Screen::write_warnings(const output::Composite* composite, const ViewState& state,
                            const ScreenFacts& facts) {
  if (composite == nullptr) return;
  const int s = scale();
  int y = 4 * s;
  TextLine words;
  if (facts.without_depth) {
    words.set("NO DEPTH FOR {:.1f} s: PEOPLE ARE NOT KEYED", seconds(*facts.without_depth));
    line(4 * s, y, words.view(), kAlarm);
  }
  if (missing(*composite, capture::Stream::kFisheye))
    line(4 * s, y, "no fisheye picture", kWarning);
  if (missing(*composite, capture::Stream::kPanTilt))
    line(4 * s, y, "angle of the pan-tilt head unknown", kWarning);
  if (state.on(Overlay::kPose) && !composite->pose.ok()) {
    words.set("POSE LOST ({}): OBJECTS {}", capture::name(composite->pose.loss),
              composite->objects_shown ? "FROZEN" : "HIDDEN");
    line(4 * s, y, words.view(), kAlarm);
  }
  if (!facts.fault.empty()) line(4 * s, y, facts.fault.view(), kAlarm);
  if (state.on(Overlay::kSync))
    for (const TextLine& sync : facts.sync) line(4 * s, y, sync.view(), kInk);
}

/// Writes view, rate, delay, recording and the answer to a key along the bottom.
void Screen::write_corner(const ViewState& state, const ScreenFacts& facts) {
  const int s = scale(), step = (kGlyphHeight_px + 2) * s;
  int y = picture_.height() - 3 * s - step;
  int x = 4 * s;
  const auto beside = [&](std::string_view text, Rgb8 ink) {
    int row = y;
    line(x, row, text, ink);
    x += text_size(text, s).width + 2 * kAdvance_px * s;
  };
  TextLine words;
  if (state.view != View::kComposite) beside(name(state.view), kInk);
  if (facts.recording) beside("REC", kRecording);
  if (state.on(Overlay::kRate)) {
    words.set("{:.1f} pictures per second", facts.shown_hz);
    beside(words.view(), kInk);
  }
  if (state.on(Overlay::kDelay)) {
    words.set("delay unknown");
    if (facts.delay) words.set("delay {:.0f} ms", milliseconds(*facts.delay));
    beside(words.view(), kInk);
  }
  y -= step;
  x = 4 * s;
  if (!facts.message.empty()) beside(facts.message.view(), kWarning);
}

void Screen::write_help() {
  const int s = scale();
  int y = std::max(4 * s, (picture_.height() - static_cast<int>(kKeys.size()) * 9 * s) / 2);
  const int x = picture_.width() / 2 - 14 * kAdvance_px * s;
  TextLine words;
  for (const KeyHelp& key : kKeys) {
    if (key.key == ' ')
      words.set("Space {}", key.what);
    else if (key.key == kFullScreenKey)
      words.set("Enter {}", key.what);
    else if (key.key == kEscape)
      words.set("Esc   {}", key.what);
    else
      words.set("{:<5} {}", static_cast<char>(std::toupper(key.key)), key.what);
    line(x, y, words.view(), kInk);
  }
}

Drawn Screen::draw(const output::Composite* composite, const ViewState& state,
                   const ScreenFacts& facts) {
  const bool gone = freshness(facts.since_last, facts.rate_hz) == Freshness::kGone;
  const render::GpuPicture* const below = draw_picture(composite, state, gone);
  write_warnings(gone ? nullptr : composite, state, facts);
  write_banner(composite, state, facts);
  write_corner(state, facts);
  if (state.on(Overlay::kHelp)) write_help();
  return {picture_, below, is_clear_};
}

}  // namespace mixrig::viewfinder

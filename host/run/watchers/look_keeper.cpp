// SPDX-License-Identifier: Apache-2.0
#include "host/run/watchers/look_keeper.h"

#include <cmath>
#include <mutex>
#include <utility>

#include <nlohmann/json.hpp>

#include "hal/base/log.h"
#include "host/render/frame/frame_motion.h"

namespace mixrig::session {

/// write() and finish() on the thread of the sink; take() on any.
class LookSink final : public output::CompositeSink {
 public:
  explicit LookSink(const render::CompositorSetup& setup) : meter_(setup) {}

  std::string_view name() const override { return "look"; }
  render::OutputMask wanted(int /*number*/) const override { return 0; }
  Result<void> write(const output::CompositePtr& composite) override {
    const HostTime begin = clock_.now();
    const render::PictureLook look = measure(plate_of(*composite->capture));
    report_.watch_ms.add(milliseconds(clock_.now() - begin));
    ++report_.looks;
    const std::lock_guard lock(mutex_);
    found_ = look;
    return {};
  }
  Result<void> finish() override { return {}; }

  /// Measures the look of a plate. Another thread may call it only before the first write().
  render::PictureLook measure(ImageView<const Rgb8> plate) {
    last_ = meter_.measure(plate, last_);
    return last_;
  }
  std::optional<render::PictureLook> take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(found_, std::nullopt);
  }
  const LookReport& report() const { return report_; }

 private:
  render::LookMeter meter_;
  render::PictureLook last_;
  SystemClock clock_;
  LookReport report_;
  std::mutex mutex_;
  std::optional<render::PictureLook> found_;  ///< guarded by mutex_
};

namespace {

constexpr float kNearest_m = 2;

nlohmann::json look_json(const render::PictureLook& look) {
  const render::Grain& g = look.grain;
  return {{"noise", std::sqrt(g.floor.y + 0.2F * g.slope.y)},
          {"blur_px", look.blur_px},
          {"chroma_px", {look.chroma_px.x, look.chroma_px.y}},
          {"sharpening", look.sharpening}};
}

}  // namespace

nlohmann::json to_json(const LookReport& report) {
  return {{"looks", report.looks},
          {"moved", report.moved},
          {"first", look_json(report.first)},
          {"last", look_json(report.last)},
          {"watch_ms", report.watch_ms.count() > 0 ? report.watch_ms.quantile(0.5) : 0.0}};
}

glm::vec2 way_of_view_px(const render::CameraMotion& motion, const geometry::Pinhole& view) {
  render::MotionParams params;
  params.motion = motion;
  params.focal_px = {view.fx_px, view.fy_px};
  params.center_px = {view.cx_px, view.cy_px};
  glm::vec2 longest(0);
  for (const float x : {0.0F, 0.5F, 1.0F})
    for (const float y : {0.0F, 0.5F, 1.0F})
      for (const float w : {0.0F, 1 / kNearest_m}) {
        const glm::vec2 px(x * static_cast<float>(view.size_px.width),
                           y * static_cast<float>(view.size_px.height));
        const glm::vec2 way = render::motion_px(params, px, w);
        if (glm::dot(way, way) > glm::dot(longest, longest)) longest = way;
      }
  return longest;
}

void LookKeeper::open(WorkGate* gate) {
  const render::CompositorSetup& setup = session_.setup;
  if (!session_.scene.look.follow || !setup.look.measures() || setup.objects.empty()) return;
  watch_.open(std::make_unique<LookSink>(setup), live_, gate);
}

/// Way of the picture during the exposure; nullopt where it is unknown.
std::optional<glm::vec2> LookKeeper::way_px(const output::Composite& composite) const {
  if (!session_.poses || !session_.poses->info().moves) return glm::vec2(0);
  if (!composite.motion) return std::nullopt;
  return way_of_view_px(*composite.motion, composite.view);
}

Result<void> LookKeeper::push(const output::CompositePtr& composite) {
  const int number = composite->capture->number;
  if (watch_.sink() == nullptr || follower_.empty()) return {};
  const std::optional<glm::vec2> way = way_px(*composite);
  const bool stands = way && glm::length(*way) < kMostWay_px;
  if (way && !std::exchange(first_is_judged_, true) && !stands) follower_.take_motion_out(*way);
  if (number < next_look_) return {};
  if (!stands) {
    ++moved_;
    return {};
  }
  next_look_ = number + kLookStep;
  return watch_.push(composite);
}

const render::PictureLook* LookKeeper::look_of(const output::Composite& composite) {
  if (watch_.sink() == nullptr) return nullptr;
  if (follower_.empty()) {
    first_ = watch_.sink()->measure(plate_of(*composite.capture));
    log_info("session", render::to_text(first_));
    follower_.add(first_);
  } else if (const auto found = watch_.sink()->take()) {
    follower_.add(*found);
  }
  return &follower_.at(composite.capture->time_s);
}

Result<void> LookKeeper::finish() { return watch_.finish(); }

std::optional<LookReport> LookKeeper::report() const {
  if (watch_.sink() == nullptr || follower_.empty()) return std::nullopt;
  LookReport report = watch_.sink()->report();
  report.moved = moved_, report.first = first_, report.last = follower_.aim();
  return report;
}

}  // namespace mixrig::session

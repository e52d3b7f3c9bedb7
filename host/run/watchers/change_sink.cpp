// SPDX-License-Identifier: Apache-2.0
#include "host/run/watchers/change_sink.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "hal/base/log.h"

namespace mixrig::session {
namespace {

/// Metres: surfaces further away are seen through windows.
constexpr float kFarthestSurface_m = 12;
constexpr int kBoundStep_px = 4;

/// Around the surfaces of the models and the camera, world: things appear between them.
Eigen::AlignedBox3d bounds_of(const std::vector<render::BackgroundModel>& models,
                              const Eigen::Vector3d& eye_m) {
  Eigen::AlignedBox3d box_m(eye_m);
  for (const render::BackgroundModel& model : models)
    for (std::size_t f = 0; f < model.world_from_face.size(); ++f)
      for (int y = 0; y < model.camera.size_px.height; y += kBoundStep_px) {
        const float* z = model.depth_m.row(static_cast<int>(f) * model.camera.size_px.height + y);
        for (int x = 0; x < model.camera.size_px.width; x += kBoundStep_px) {
          if (!(z[x] > 0 && z[x] < kFarthestSurface_m)) continue;
          const Eigen::Vector2d ray = model.camera.unproject({x, y});
          box_m.extend(model.world_from_face[f] *
                       (Eigen::Vector3d(ray.x(), ray.y(), 1) * double{z[x]}));
        }
      }
  return box_m;
}

/// Means of the colours that a pixel of depth has; unknown where one of them is.
Image<Rgbx8> coarse(const render::BackgroundModel& model) {
  const int f = model.color_factor;
  Image<Rgbx8> out(model.depth_m.size);
  for (int y = 0; y < out.height(); ++y)
    for (int x = 0; x < out.width(); ++x) {
      int r = 0, g = 0, b = 0, most = 0;
      for (int j = 0; j < f; ++j)
        for (int i = 0; i < f; ++i) {
          const Rgbx8& c = model.color.row(y * f + j)[x * f + i];
          r += c.r, g += c.g, b += c.b, most = std::max<int>(most, c.x);
        }
      const auto mean = [n = f * f](int sum) { return static_cast<std::uint8_t>(sum / n); };
      out.row(y)[x] = {mean(r), mean(g), mean(b), static_cast<std::uint8_t>(most)};
    }
  return out;
}

Size watch_size(Size view) {
  const int width = std::min(view.width, ChangeSink::kWidth_px);
  return {width, std::max(1, width * view.height / view.width)};
}

}  // namespace

bool ChangeSink::can_watch(const Session& session) {
  const render::CompositorSetup& setup = session.setup;
  const bool drawn = !setup.background_models.empty();
  const bool still = session.background && !(session.poses && session.poses->info().moves);
  return (drawn || still) && !setup.lens_moves;
}

bool ChangeSink::can_scan(const Session& session) {
  return can_watch(session) && session.background && session.rooms.empty() &&
         session.setup.background_models.empty();
}

Result<std::unique_ptr<ChangeSink>> ChangeSink::create(const Session& session,
                                                       const ChangeOptions& options,
                                                       output::RunOrders* orders) {
  std::unique_ptr<ChangeSink> sink(new ChangeSink(session, options, orders));
  MIXRIG_TRY(sink->open());
  return sink;
}

ChangeSink::ChangeSink(const Session& session, const ChangeOptions& options,
                       output::RunOrders* orders)
    : session_(session), options_(options), orders_(orders), small_(session.setup) {
  small_.view = resized(session.setup.view, watch_size(session.setup.view.size_px));
  kept_frames_.reserve(kLearnFrames);
}

Result<void> ChangeSink::open() {
  MIXRIG_ASSIGN(views_, FrameViews::make(small_, {render::Backend::kCpu, 1}));
  return {};
}

/// The background that is in force, in the size of the watch.
void ChangeSink::draw_background() {
  drawn_.reset();  // no two of them at once
  // The drawn models are only read here, not kept.
  Image<Rgbx8> color;  // of a still camera's view
  std::vector<render::BackgroundModel> models =
      kept_ ? kept_->models(*first_pose_) : models_of(session_, *first_pose_, color);
  std::vector<Image<Rgbx8>> coarse_colors(models.size());
  for (std::size_t i = 0; i < models.size(); ++i) {
    if (models[i].color.empty() || models[i].color_factor == 1) continue;
    coarse_colors[i] = coarse(models[i]);
    models[i].color = coarse_colors[i], models[i].color_factor = 1;
  }
  render::CompositorSetup setup = small_;
  setup.tof = {small_.view, {}};  // no finer than the watch
  setup.background = {};
  setup.background_models = models;
  drawn_ = std::make_unique<render::cpu::MovingBackground>(crew_, setup,
                                                           render::cpu::DrawnFor::kPictures);
  drawn_at_.reset();
  if (!watch_)
    watch_.emplace(bounds_of(models, first_pose_->translation_m), small_.noise, options_.watch);
}

Result<void> ChangeSink::write(const output::CompositePtr& composite) {
  if (!composite->pose.ok()) return {};
  if (!first_pose_) {
    first_pose_ = composite->world_from_target;
    draw_background();
  }
  const HostTime begin = clock_.now();
  MIXRIG_TRY(look(*composite));
  report_.watch_ms.add(milliseconds(clock_.now() - begin));
  MIXRIG_TRY(scan(*composite));
  return collect(*composite);
}

Result<void> ChangeSink::look(const output::Composite& composite) {
  constexpr int kColumns = render::cpu::MovingBackground::kMostColumns;
  const geometry::Pose& pose = composite.world_from_target;
  if (!drawn_at_ || capture::moved(*drawn_at_, pose)) {
    drawn_->draw(crew_, pose);
    const Size size = drawn_->has_color() ? small_.view.size_px : Size{};
    drawn_color_.reset(size);
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; x += kColumns)
        drawn_->colors(x, y,
                       {drawn_color_.row(y) + x,
                        static_cast<std::size_t>(std::min(kColumns, size.width - x))});
    drawn_at_ = pose;
  }
  MIXRIG_ASSIGN(const render::FrameOutput* const seen, views_->of(*composite.capture));
  const render::BackgroundView background = drawn_->view();
  const bool news = watch_->add({composite.capture->time_s, small_.view, pose, seen->warped_depth_m,
                                 seen->color, background.depth_m, drawn_color_});
  if (news) tell();
  return {};
}

void ChangeSink::tell() {
  for (const model::RoomChange& change : watch_->news())
    log_warning("session", fmt::format("the room has changed: {} (seen for {:.1f} s, {:.0f} %)",
                                       model::text(change), change.found_s - change.since_s,
                                       100 * change.certainty));
}

/// Collects frames to learn from while there are changes to accept, and then learns them.
Result<void> ChangeSink::collect(const output::Composite& composite) {
  bool asked = false;
  while (orders_ != nullptr && orders_->take<output::LearnChanges>()) asked = true;
  if (!watch_->any_open()) {
    if (asked) log_warning("session", "nothing that changed in the room waits to be accepted");
    collecting_ = false;
    kept_frames_.clear();
    return {};
  }
  collecting_ |= asked || options_.accept_all;
  if (!collecting_) return {};
  if (watch_->seen_share() < 0.5) {
    if (asked)
      log_warning("session",
                  "what changed is hidden by people: it is learned once half of it is seen");
    return {};
  }
  kept_frames_.push_back({composite.capture, composite.world_from_target});
  if (kept_frames_.size() < kLearnFrames) return {};
  return learn();
}

Result<void> ChangeSink::learn() {
  const HostTime begin = clock_.now();
  auto next =
      kept_ ? std::make_shared<KeptBackground>(*kept_) : std::make_shared<KeptBackground>(session_);
  MIXRIG_TRY(learn_changes(*watch_, kept_frames_, *first_pose_, *next));
  kept_frames_.clear();
  collecting_ = false;
  watch_->accept();
  ++report_.accepted;
  hand_out(std::move(next));
  report_.learn_ms.add(milliseconds(clock_.now() - begin));
  log_warning("session", "what changed in the room is background from now on");
  return {};
}

void ChangeSink::hand_out(std::shared_ptr<KeptBackground> next) {
  kept_ = next;
  draw_background();
  const std::lock_guard lock(mutex_);
  learned_ = std::move(next);
}

/// Follows orders to learn the room; the last one counts, and restarts a scan that is at work.
Result<void> ChangeSink::obey_scan_orders() {
  while (const auto order = orders_->take<output::LearnRoom>()) {
    scan_.reset(), scan_views_.reset();
    scan_left_ = order->on ? output::kScanLooks : 0;
  }
  if (scan_left_ == 0 || scan_) return {};
  MIXRIG_ASSIGN(scan_views_, FrameViews::make(session_.setup, {render::Backend::kCpu, 1}));
  scan_.emplace(session_.setup.view, output::kScanLooks);
  return {};
}

/// Adds one frame of the whole room to a scan that was ordered.
Result<void> ChangeSink::scan(const output::Composite& composite) {
  if (orders_ == nullptr) return {};
  MIXRIG_TRY(obey_scan_orders());
  if (!scan_) return {};
  MIXRIG_ASSIGN(const render::FrameOutput* const seen, scan_views_->of(*composite.capture));
  MIXRIG_TRY(scan_->add(seen->warped_depth_m, seen->color));
  if (scan_left_ == 1) use_scan();
  --scan_left_;
  orders_->tell([left = scan_left_](output::RunState& run) { run.scan_left = left; });
  return {};
}

void ChangeSink::use_scan() {
  auto learned = scan_->finish();
  scan_.reset(), scan_views_.reset();
  if (!learned)
    return log_warning("session", "the room was not learned: " + to_line(learned.error()));
  auto next =
      kept_ ? std::make_shared<KeptBackground>(*kept_) : std::make_shared<KeptBackground>(session_);
  next->replace_view(*std::move(learned));
  watch_.reset();  // it knows changes of the old one
  hand_out(std::move(next));
  log_warning("session", "the room was learned anew: it is the background from now on");
}

std::shared_ptr<KeptBackground> ChangeSink::take_learned() {
  const std::lock_guard lock(mutex_);
  return std::exchange(learned_, nullptr);
}

RoomChangesReport ChangeSink::report() const {
  RoomChangesReport report = report_;
  if (watch_) report.changes = watch_->changes();
  return report;
}

}  // namespace mixrig::session

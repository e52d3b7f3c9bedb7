// SPDX-License-Identifier: Apache-2.0
#include "host/run/session/quality.h"

#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hal/base/log.h"
#include "host/run/session/frame_cost.h"

namespace mixrig::session {
namespace {

using scene::FocusRung;
using scene::KeyRung;
using scene::LightRung;
using scene::Rungs;

/// Steps from the quality levels of a scene to faster ones, in order.
std::vector<std::function<void(Rungs&)>> steps_down(const Rungs& from, bool has_focus,
                                                    bool has_objects) {
  std::vector<std::function<void(Rungs&)>> steps;
  if (has_focus && from.focus == FocusRung::kFine)
    steps.emplace_back([](Rungs& r) { r.focus = FocusRung::kFast; });
  if (has_objects && from.light == LightRung::kPeople)
    steps.emplace_back([](Rungs& r) { r.light = LightRung::kShadows; });
  if (from.key == KeyRung::kRefined) steps.emplace_back([](Rungs& r) { r.key = KeyRung::kVotes; });
  if (has_objects && from.light != LightRung::kPlain)
    steps.emplace_back([](Rungs& r) { r.light = LightRung::kPlain; });
  if (from.key != KeyRung::kPlain) steps.emplace_back([](Rungs& r) { r.key = KeyRung::kPlain; });
  return steps;
}

/// Whether a pixel, in shares of the picture, lies in one of the two people.
bool in_people(double x, double y) {
  const auto within = [&](double middle) {
    const double dx = (x - middle) / 0.08, dy = (y - 0.55) / 0.36;
    return dx * dx + dy * dy < 1;
  };
  return within(0.32) || within(0.66);
}

template <typename T, typename Change>
void change_people(Image<T>& image, Change change) {
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x)
      if (in_people((x + 0.5) / image.width(), (y + 0.5) / image.height())) change(image.row(y)[x]);
}

void put_nearer(float& depth_m) {
  constexpr float kShare = 0.6F, kUnknown_m = 3;
  depth_m = kShare * (depth_m > 0 && depth_m < 100 ? depth_m : kUnknown_m);
}

void set_rungs(const Rungs& rungs, Session& session) {
  scene::Quality& quality = session.scene.quality;
  quality.key = rungs.key, quality.light = rungs.light;
  if (session.scene.focus) quality.focus = rungs.focus;
  set_scene(session.scene, session.meshes, session.setup);
}

}  // namespace

void paint_people(capture::Capture& capture) {
  change_people(capture.depth_m, put_nearer);
  change_people(capture.depth2.depth_m, put_nearer);
  change_people(capture.plate, [](Rgb8& c) {
    const auto inverted = [](std::uint8_t v) { return static_cast<std::uint8_t>(255 - v); };
    c = {inverted(c.r), inverted(c.g), inverted(c.b)};
  });
}

Result<QualityChoice> choose_rungs(const Rungs& wanted, bool has_focus, bool has_objects,
                                   double budget_ms,
                                   const std::function<Result<double>(const Rungs&)>& measure) {
  constexpr double kSaves = 0.98;
  QualityChoice choice{budget_ms, wanted, 0, {}};
  MIXRIG_ASSIGN(choice.ms, measure(wanted));
  choice.trials.push_back({scene::to_text(wanted, has_focus), choice.ms, true});
  for (const auto& step : steps_down(wanted, has_focus, has_objects)) {
    if (choice.fits()) break;
    Rungs next = choice.rungs;
    step(next);
    MIXRIG_ASSIGN(const double ms, measure(next));
    const bool saves = ms < kSaves * choice.ms;
    choice.trials.push_back({scene::to_text(next, has_focus), ms, saves});
    if (saves) choice.rungs = next, choice.ms = ms;
  }
  return choice;
}

Result<std::optional<QualityChoice>> follow_budget(Session& session, int first_frame,
                                                   const Clock& clock) {
  if (!session.scene.quality.budget_ms) return std::optional<QualityChoice>();
  capture::Capture capture;
  MIXRIG_ASSIGN(const bool there, session.source->read(first_frame, capture));
  if (!there) return Error{ErrorCode::kData, "the source has no frame to measure the budget with"};
  if (capture.depth_m.empty()) capture.depth_m.reset(session.setup.tof.size_px());
  paint_people(capture);
  const double step_m = session.poses && session.poses->info().moves ? 0.001 : 0;
  const Rungs wanted = scene::rungs_of(session.scene);
  MIXRIG_ASSIGN(
      QualityChoice choice,
      choose_rungs(wanted, session.setup.focus.has_value(), !session.setup.objects.empty(),
                   *session.scene.quality.budget_ms, [&](const Rungs& rungs) {
                     set_rungs(rungs, session);
                     return frame_cost_ms(session, capture, 2, 9, step_m, clock);
                   }));
  set_rungs(choice.rungs, session);
  const std::string chosen = scene::to_text(choice.rungs, session.setup.focus.has_value());
  if (choice.fits())
    log_info("session", fmt::format("quality: {}: {:.1f} ms a frame of {:.1f}", chosen, choice.ms,
                                    choice.budget_ms));
  else
    log_warning(
        "session",
        fmt::format("{}: quality.budget_ms = {}: the fastest quality levels ({}) take {:.1f} ms a "
                    "frame: composite smaller (--size), or give more",
                    session.scene.path.string(), choice.budget_ms, chosen, choice.ms));
  return std::optional(std::move(choice));
}

nlohmann::json to_json(const QualityChoice& choice) {
  nlohmann::json trials = nlohmann::json::array();
  for (const QualityTrial& t : choice.trials)
    trials.push_back({{"levels", t.rungs}, {"ms", t.ms}, {"kept", t.kept}});
  return {{"budget_ms", choice.budget_ms},
          {"fits", choice.fits()},
          {"key", scene::name(choice.rungs.key)},
          {"light", scene::name(choice.rungs.light)},
          {"focus", scene::name(choice.rungs.focus)},
          {"ms", choice.ms},
          {"trials", trials}};
}

std::string to_text(const QualityChoice& choice) {
  std::string out;
  for (const QualityTrial& t : choice.trials)
    out += fmt::format("  {:<10} {:<11} {:>8.2f}  {}{}\n", "quality", "", t.ms, t.rungs,
                       t.kept ? t.ms <= choice.budget_ms ? ": within the budget" : ": too slow"
                              : ": saves nothing, taken back");
  return out + fmt::format("  {:<10} {:<11} {:>8.2f}  {}\n", "budget", "", choice.budget_ms,
                           choice.fits() ? "ms a frame, kept" : "ms a frame, not reached");
}

}  // namespace mixrig::session

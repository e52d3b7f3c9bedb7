// SPDX-License-Identifier: Apache-2.0
#include "host/judge/bench/suites.h"

#include <algorithm>
#include <map>
#include <thread>

#include <fmt/format.h>

#include "hal/base/log.h"
#include "host/judge/bench/peers.h"
#include "host/judge/bench/rung_contender.h"

namespace mixrig::bench {
namespace {

using measure::Errors;
using render::Stage;
using session::BackendChoice;

/// Rungs, and of the view's width and height so many quarters.
struct SizedRung {
  Rung rung;
  int quarters = 4;
};

struct Plan {
  std::string plot_key, plot_label;
  std::vector<Measure> measures;
  std::vector<SizedRung> rungs;
};

constexpr BackendChoice kOneThread{render::Backend::kCpu, 1}, kAllThreads{render::Backend::kCpu, 0},
    kGles{render::Backend::kGles, 0};

std::string all_threads() {
  const unsigned threads = std::max(1U, std::thread::hardware_concurrency());
  return fmt::format("cpu, {} thread{}", threads, threads == 1 ? "" : "s");
}

// Keys of docs/reference/measures.md.
std::optional<double> missed_key_pct(const Errors& e) {
  return e.key_iou ? std::optional(100 * (1 - *e.key_iou)) : std::nullopt;
}
constexpr Measure kHiddenWrong{"hidden_wrong_pct",
                               [](const Errors& e) { return e.hidden_wrong_pct; }};
constexpr Measure kKeyIou{"key_iou", [](const Errors& e) { return e.key_iou; }};
constexpr Measure kKeyWrong{"key_wrong_pct", missed_key_pct};
constexpr Measure kMatteMse{"matte_mse", [](const Errors& e) { return e.matte_mse; }};
constexpr Measure kBandKeyIou{"contested_key_iou",
                              [](const Errors& e) { return e.contested.key_iou; }};
constexpr Measure kBandMatteMse{"contested_matte_mse",
                                [](const Errors& e) { return e.contested.matte_mse; }};
constexpr Measure kFlicker{"matte_flicker", [](const Errors& e) { return e.matte_flicker; }};
constexpr Measure kOrderWrong{"order_wrong_pct", [](const Errors& e) { return e.order_wrong_pct; }};
constexpr Measure kColor{"color_psnr_db", [](const Errors& e) { return e.color_psnr_db; }};
constexpr Measure kBandColor{"contested_color_psnr_db",
                             [](const Errors& e) { return e.contested.color_psnr_db; }};
constexpr Measure kLight{"light_rmse", [](const Errors& e) { return e.light_rmse; }};
constexpr Measure kShadow{"light_shadow_rmse", [](const Errors& e) { return e.light_shadow_rmse; }};
constexpr Measure kObject{"object_rmse", [](const Errors& e) { return e.object_rmse; }};

using Setup = render::CompositorSetup;

void by_depth(Setup& s) { s.key.color = s.key.refine = false; }
void by_votes(Setup& s) { s.key.color = true, s.key.refine = false; }
void refined(Setup& s) { s.key.color = s.key.refine = true; }
void without_objects(Setup& s) { s.objects.clear(); }
void without_shadows(Setup& s) {
  s.people_cast_shadows = false;
  for (render::VirtualObject& object : s.objects) object.casts_shadow = false;
}
void with_peoples_shadows(Setup& s) { s.people_cast_shadows = true; }
/// Sharp where the middle of the picture is.
void add_focus(Setup& s, bool fast) {
  s.focus = render::Focus{.pixel = glm::ivec2(s.view.size_px.width / 2, s.view.size_px.height / 2),
                          .aperture_m = 0.02F,
                          .most_blur_px = 0.02F * static_cast<float>(s.view.size_px.width),
                          .fast = fast};
}

Plan warp_plan() {
  Plan plan{"band_bad_pct", "wrong or unknown near depth steps, %", {kHiddenWrong}, {}};
  for (const auto& [name, backend] :
       {std::pair<std::string, BackendChoice>{"cpu, 1 thread", kOneThread},
        {all_threads(), kAllThreads},
        {"gles", kGles}})
    plan.rungs.push_back({{name,
                           backend,
                           {},
                           {Stage::kCorrect, Stage::kWarp},
                           false,
                           true,
                           Look::kWarped,
                           plan.measures}});
  return plan;
}

Plan refine_plan() {
  Plan plan{"band_bad_pct", "depth wrong or unknown near depth steps, %", {kMatteMse}, {}};
  const auto add = [&](const char* name, BackendChoice backend, void (*change)(Setup&)) {
    plan.rungs.push_back({{name,
                           backend,
                           [change](Setup& s) { without_objects(s), change(s); },
                           {Stage::kKey},
                           false,
                           true,
                           Look::kMixed,
                           plan.measures}});
  };
  plan.rungs.push_back(
      {{"warped depth", kOneThread, without_objects, {}, false, false, Look::kWarped, {}}});
  add("key by depth, 1 thread", kOneThread, by_depth);
  add("votes, 1 thread", kOneThread, by_votes);
  add("refined, 1 thread", kOneThread, refined);
  add("refined, all threads", kAllThreads, refined);
  return plan;
}

Plan key_plan() {
  Plan plan{"key_wrong_pct",
            "wrongly keyed, % of the people (1 - key_iou)",
            {kKeyIou, kKeyWrong, kMatteMse, kBandKeyIou, kBandMatteMse, kFlicker, kOrderWrong},
            {}};
  const auto add = [&](const char* name, BackendChoice backend, void (*change)(Setup&)) {
    plan.rungs.push_back(
        {{name, backend, change, {Stage::kKey}, false, true, Look::kComposite, plan.measures}});
  };
  add("depth, 1 thread", kOneThread, by_depth);
  add("votes, 1 thread", kOneThread, by_votes);
  add("refined, 1 thread", kOneThread, refined);
  add("refined, all threads", kAllThreads, refined);
  add("refined, gles", kGles, refined);
  return plan;
}

Plan mix_plan() {
  Plan plan{"rms_error",
            "root mean square error of the colour, of 255",
            {kColor,
             kBandColor,
             kOrderWrong,
             {"rms_error",
              [](const Errors& e) {
                return e.color_psnr_db ? std::optional(255 * std::pow(10, -*e.color_psnr_db / 20))
                                       : std::nullopt;
              }}},
            {}};
  const auto add = [&](const char* name, BackendChoice backend, std::function<void(Setup&)> change,
                       bool judged = true) {
    plan.rungs.push_back({{name,
                           backend,
                           std::move(change),
                           {Stage::kPlate, Stage::kLight, Stage::kMix, Stage::kFocus},
                           false,
                           true,
                           Look::kComposite,
                           judged ? plan.measures : std::vector<Measure>{}}});
  };
  add("no shadows, 1 thread", kOneThread, without_shadows);
  add("shadows, 1 thread", kOneThread, {});
  add("shadows, all threads", kAllThreads, {});
  add("shadows, gles", kGles, {});
  // The truth has no depth of field.
  add(
      "focus fast, 1 thread", kOneThread, [](Setup& s) { add_focus(s, true); }, false);
  add(
      "focus fine, 1 thread", kOneThread, [](Setup& s) { add_focus(s, false); }, false);
  return plan;
}

Plan shadow_plan() {
  Plan plan{"light_shadow_rmse",
            "root mean square error of the light in shadows",
            {kLight, kShadow, kObject},
            {}};
  const auto add = [&](const char* name, BackendChoice backend, std::function<void(Setup&)> change,
                       bool moves = true) {
    plan.rungs.push_back({{name,
                           backend,
                           std::move(change),
                           {Stage::kVirtual, Stage::kShadow, Stage::kLight},
                           moves,
                           true,
                           Look::kComposite,
                           plan.measures}});
  };
  add("none, moving", kOneThread, without_shadows);
  add("objects, moving", kOneThread, {});
  add("objects, still", kOneThread, {}, false);
  add("objects and people, moving", kOneThread, with_peoples_shadows);
  add("objects and people, still", kOneThread, with_peoples_shadows, false);
  add("objects, constant ambient light, moving", kOneThread,
      [](Setup& s) { s.light.by_direction = false; });
  add("objects, all threads, moving", kAllThreads, {});
  add("objects, gles, moving", kGles, {});
  return plan;
}

Plan frame_plan() {
  Plan plan{"key_wrong_pct",
            "wrongly keyed, % of the people (1 - key_iou)",
            {kKeyIou, kKeyWrong, kBandKeyIou, kOrderWrong, kColor},
            {}};
  const auto add = [&](const std::string& name, BackendChoice backend,
                       std::function<void(Setup&)> change, bool moves = false, int quarters = 4) {
    plan.rungs.push_back(
        {{name, backend, std::move(change), {}, moves, true, Look::kComposite, plan.measures},
         quarters});
  };
  add("1 thread", kOneThread, {});
  add("all threads", kAllThreads, {});
  add("all threads, moving", kAllThreads, {}, true);
  add("all threads, key by votes", kAllThreads, by_votes);
  add("all threads, key by depth", kAllThreads, by_depth);
  add("all threads, no shadows", kAllThreads, without_shadows);
  add("all threads, 3/4 of the size", kAllThreads, {}, false, 3);
  add("all threads, 1/2 of the size", kAllThreads, {}, false, 2);
  add("gles", kGles, {});
  return plan;
}

Plan memory_plan() {
  Plan plan{"heap_mb", "held by compositor and images, MB", {}, {}};
  for (const int quarters : {2, 3, 4})
    plan.rungs.push_back({{fmt::format("cpu, {}/4 of the size", quarters),
                           kAllThreads,
                           {},
                           {},
                           false,
                           true,
                           Look::kComposite,
                           {},
                           true},
                          quarters});
  plan.rungs.push_back(
      {{"cpu, key by depth", kAllThreads, by_depth, {}, false, true, Look::kComposite, {}, true}});
  plan.rungs.push_back({{"gles", kGles, {}, {}, false, true, Look::kComposite, {}, true}});
  return plan;
}

Plan plan_of(const std::string& suite) {
  if (suite == "warp") return warp_plan();
  if (suite == "refine") return refine_plan();
  if (suite == "key") return key_plan();
  if (suite == "mix") return mix_plan();
  if (suite == "shadow") return shadow_plan();
  return suite == "frame" ? frame_plan() : memory_plan();
}

}  // namespace

bool is_suite(std::string_view name) {
  return std::find(kSuites.begin(), kSuites.end(), name) != kSuites.end();
}

Result<Suite> run_suite(const std::string& name, const SuiteOptions& options,
                        const ProgressFn& progress) {
  const SystemClock clock;
  Plan plan = plan_of(name);
  std::map<int, SessionPtr> sessions;  // by quarters of the size
  MIXRIG_ASSIGN(sessions[4], open_input(options.take, {}, clock, progress));
  const Size full = sessions[4]->setup.view.size_px;
  MIXRIG_ASSIGN(const auto frames, read_frames(*sessions[4], options.quick ? 6 : 24));
  std::vector<ContenderPtr> contenders;
  for (SizedRung& sized : plan.rungs) {
    SessionPtr& session = sessions[sized.quarters];
    if (!session) {
      const Size part{full.width * sized.quarters / 4, full.height * sized.quarters / 4};
      MIXRIG_ASSIGN(session, open_input(options.take, part, clock, progress));
    }
    const bool gles = sized.rung.backend.backend == render::Backend::kGles;
    if (gles && options.quick) continue;
    auto contender = open_rung(std::move(sized.rung), *session, frames);
    if (contender)
      contenders.push_back(*std::move(contender));
    else if (gles)
      log_warning("bench", "left out gles: " + to_line(contender.error()));
    else
      return contender.error();
  }
  MIXRIG_TRY(add_peers(name, options.grid, *sessions[4], frames, plan.measures, contenders));
  Suite suite{name, plan.plot_key, plan.plot_label, {}};
  MIXRIG_ASSIGN(suite.rows,
                measure_all(contenders, frames.size(), options.quick ? 1 : 3, name, progress));
  return suite;
}

}  // namespace mixrig::bench

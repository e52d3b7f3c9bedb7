// SPDX-License-Identifier: Apache-2.0
#include "extras/people/watch/people_extra.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace mixrig::session {
namespace {

std::string number_of_objects(std::size_t n) {
  return std::to_string(n) + (n == 1 ? " object" : " objects");
}

/// "a, b and c".
std::string listed(const std::vector<std::string>& things) {
  std::string out;
  for (std::size_t i = 0; i < things.size(); ++i)
    out += (i == 0 ? "" : i + 1 < things.size() ? ", " : " and ") + things[i];
  return out;
}

std::string people_reason(const scene::Scene& scene, bool physics) {
  std::vector<std::string> wanted;
  if (scene.follow_people) wanted.push_back("[people]");
  if (scene.events) wanted.push_back("[events]");
  if (physics) wanted.push_back("physics");
  return wanted.empty() ? "not run: the scene has neither [people] follow, [events] nor physics"
                        : "people are followed for " + listed(wanted) + ", beside the frames";
}

std::string touch_reason(const scene::Scene& scene, bool physics) {
  if (!scene.events && !physics) return "not run: the scene has neither [events] nor physics";
  std::string reason = "who touches " + number_of_objects(scene.objects.size()) +
                       ", beside the frames; written to events.jsonl";
  if (!scene.events) return reason;
  if (!scene.events->udp.empty()) reason += ", as JSON to " + scene.events->udp;
  if (!scene.events->osc.empty()) reason += ", as OSC to " + scene.events->osc;
  return scene.events->people ? reason + ", with the places of people" : reason;
}

double p50(const measure::QuantileSketch& times_ms) {
  return times_ms.count() > 0 ? times_ms.quantile(0.5) : 0.0;
}

}  // namespace

Result<std::vector<std::unique_ptr<output::CompositeSink>>> PeopleExtra::open(
    const ExtraSetup& setup) {
  session_ = &setup.session;
  const scene::Scene& scene = session_->scene;
  std::vector<std::unique_ptr<output::CompositeSink>> sinks;
  motion_ = ObjectMotion::create(*session_);
  if (!scene.follow_people && !scene.events && !motion_) return sinks;
  MIXRIG_ASSIGN(auto sink, PeopleSink::create(setup.folder, {}, people_.emplace()));
  if (scene.events || motion_) {
    MIXRIG_ASSIGN(auto touch,
                  TouchStage::create(*session_, setup.folder, motion_.get(), events_.emplace()));
    sink->watch_touch(std::move(touch));
  }
  sinks.push_back(std::move(sink));
  return sinks;
}

void PeopleExtra::add_to(nlohmann::json& report) const {
  if (people_) report["people"] = to_json(*people_);
  if (events_) report["events"] = to_json(*events_);
}

std::string PeopleExtra::lines() const {
  std::string out;
  if (people_)
    out += fmt::format("  people: {}, at most {} at once\n", people_->people.size(),
                       people_->most_at_once);
  if (events_)
    out += fmt::format("  events: {} enter, {} hit, {} leave\n", events_->counts[0],
                       events_->counts[3], events_->counts[2]);
  return out;
}

std::vector<PassLine> PeopleExtra::passes() const {
  const scene::Scene& scene = session_->scene;
  const auto moving = static_cast<std::size_t>(std::count_if(
      scene.objects.begin(), scene.objects.end(), [](const auto& o) { return o.physics; }));
  const Size size = session_->setup.view.size_px;
  const std::string view = fmt::format("{}x{}", size.width, size.height);
  return {{"people", people_ ? view : "-", people_reason(scene, moving > 0),
           people_ ? p50(people_->track_ms) : 0.0},
          {"touch", events_ ? view : "-", touch_reason(scene, moving > 0),
           events_ ? p50(events_->touch_ms) : 0.0},
          {"physics", "-",
           moving == 0
               ? "not run: no object has physics"
               : fmt::format("{} of {} move, {:.0f} steps a second", moving,
                             number_of_objects(scene.objects.size()), 1 / touch::Physics::kStep_s),
           motion_ ? p50(motion_->advance_ms()) : 0.0}};
}

}  // namespace mixrig::session

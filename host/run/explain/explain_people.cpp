// SPDX-License-Identifier: Apache-2.0
#include "host/run/explain/explain_people.h"

#include <algorithm>

#include <fmt/format.h>

#include "extras/people/touch/physics.h"

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
                       ", beside the frames; told in events.jsonl";
  if (!scene.events) return reason;
  if (!scene.events->udp.empty()) reason += ", as JSON to " + scene.events->udp;
  if (!scene.events->osc.empty()) reason += ", as OSC to " + scene.events->osc;
  return scene.events->people ? reason + ", with the places of people" : reason;
}

}  // namespace

std::vector<PassLine> people_passes(const Session& session, const RunReport& report) {
  const scene::Scene& scene = session.scene;
  const auto moving = static_cast<std::size_t>(std::count_if(
      scene.objects.begin(), scene.objects.end(), [](const auto& o) { return o.physics; }));
  const auto p50 = [](const auto& part, auto times) {
    return part ? ((*part).*times).quantile(0.5) : 0.0;
  };
  const std::string view = text(session.setup.view.size_px);
  const bool people = report.people.has_value(), events = report.events.has_value();
  return {{"people", people ? view : "-", people_reason(scene, moving > 0),
           p50(report.people, &PeopleReport::track_ms)},
          {"touch", events ? view : "-", touch_reason(scene, moving > 0),
           p50(report.events, &TouchReport::touch_ms)},
          {"physics", "-",
           moving == 0
               ? "not run: no object has physics"
               : fmt::format("{} of {} move, {:.0f} steps a second", moving,
                             number_of_objects(scene.objects.size()), 1 / touch::Physics::kStep_s),
           report.physics_ms.count() > 0 ? report.physics_ms.quantile(0.5) : 0.0}};
}

}  // namespace mixrig::session

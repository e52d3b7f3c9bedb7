// SPDX-License-Identifier: Apache-2.0
#include "extras/people/watch/event_out.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "host/output/datagrams/osc.h"

namespace mixrig::session {
namespace {

double in_ten_thousandths(double value) { return std::round(1e4 * value) / 1e4; }

const std::string& object_name(const scene::Scene& scene, int number) {
  return scene.objects[static_cast<std::size_t>(number)].name;
}

bool has_speed(const touch::Event& event) {
  return event.kind == touch::EventKind::kEnter || event.kind == touch::EventKind::kHit;
}

std::string text_of(const nlohmann::ordered_json& json) {
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

Result<std::optional<stream::DatagramSender>> sender_to(const std::string& address,
                                                        const scene::Scene& scene,
                                                        const char* key) {
  std::optional<stream::DatagramSender> none;
  if (address.empty()) return none;
  auto sender = stream::DatagramSender::open(address);
  if (!sender)
    return Error{sender.error().code,
                 scene.path.string() + ": events." + key + ": " + sender.error().context};
  return std::optional(*std::move(sender));
}

std::string people_json(std::span<const plan::Person> people, int frame, double time_s) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const plan::Person& person : people)
    list.push_back({{"id", person.id},
                    {"x_m", in_ten_thousandths(person.on_floor_m.x())},
                    {"y_m", in_ten_thousandths(person.on_floor_m.y())},
                    {"height_m", in_ten_thousandths(person.height_m)},
                    {"sight", plan::name(person.sight)}});
  return text_of({{"people", list}, {"time_s", in_ten_thousandths(time_s)}, {"frame", frame}});
}

}  // namespace

std::string event_json(const touch::Event& event, const scene::Scene& scene, int frame) {
  nlohmann::ordered_json json{{"event", touch::name(event.kind)},
                              {"time_s", in_ten_thousandths(event.time_s)},
                              {"frame", frame},
                              {"object", object_name(scene, event.object)},
                              {"with", touch::name(event.against)}};
  if (event.against == touch::Against::kPerson) json["person"] = event.other;
  if (event.against == touch::Against::kObject) json["other"] = object_name(scene, event.other);
  if (event.part != touch::RoomPart::kAny) json["part"] = touch::name(event.part);
  json["at_m"] = {in_ten_thousandths(event.at_m.x()), in_ten_thousandths(event.at_m.y()),
                  in_ten_thousandths(event.at_m.z())};
  json["depth_m"] = in_ten_thousandths(event.depth_m);
  json["sigma_m"] = in_ten_thousandths(event.sigma_m);
  json["by"] = touch::name(event.evidence);
  if (has_speed(event)) json["speed_m_s"] = in_ten_thousandths(event.speed_m_s);
  return text_of(json);
}

/// All kinds have the same arguments, so that a receiver needs one pattern.
std::string event_osc(const touch::Event& event, const scene::Scene& scene) {
  const bool person = event.against == touch::Against::kPerson;
  const bool object = event.against == touch::Against::kObject;
  stream::OscMessage message("/mixrig/touch/" + stream::osc_name(object_name(scene, event.object)) +
                             "/" + std::string(touch::name(event.kind)));
  message.add(touch::name(event.against)).add(person ? event.other : 0);
  message.add(object ? std::string_view(object_name(scene, event.other)) : touch::name(event.part));
  for (const double value : {event.at_m.x(), event.at_m.y(), event.at_m.z(), event.depth_m,
                             event.sigma_m, has_speed(event) ? event.speed_m_s : 0.0, event.time_s})
    message.add(static_cast<float>(value));
  return message.bytes();
}

Result<EventOut> EventOut::open(const scene::Scene& scene) {
  EventOut out(scene);
  if (!scene.events) return out;
  MIXRIG_ASSIGN(out.json_, sender_to(scene.events->udp, scene, "udp"));
  MIXRIG_ASSIGN(out.osc_, sender_to(scene.events->osc, scene, "osc"));
  out.people_ = scene.events->people;
  return out;
}

void EventOut::tell(const touch::Event& event, const std::string& json) {
  if (json_) json_->send(json);
  if (osc_) osc_->send(event_osc(event, *scene_));
}

void EventOut::tell(std::span<const plan::Person> people, int frame, double time_s) {
  if (!people_) return;
  if (json_) json_->send(people_json(people, frame, time_s));
  if (!osc_) return;
  stream::OscMessage all("/mixrig/people");
  for (const plan::Person& person : people) {
    all.add(person.id);
    stream::OscMessage one("/mixrig/person");
    one.add(person.id);
    for (const double value : {person.on_floor_m.x(), person.on_floor_m.y(), person.height_m})
      one.add(static_cast<float>(value));
    osc_->send(one.bytes());
  }
  osc_->send(all.bytes());
}

SentCounts EventOut::counts(const std::optional<stream::DatagramSender>& sender) {
  return sender ? SentCounts{sender->sent(), sender->dropped()} : SentCounts{};
}

}  // namespace mixrig::session

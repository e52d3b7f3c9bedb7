// SPDX-License-Identifier: Apache-2.0
// Sends events and positions of people to other programs as JSON and OSC, in UDP datagrams.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "host/output/datagrams/datagram_sender.h"
#include "extras/people/plan/people_tracker.h"
#include "extras/people/touch/contact.h"
#include "host/scene/scene.h"

namespace mixrig::session {

/// Event as one line of events.jsonl; docs/reference/events.md has its keys. `frame`: number of the
/// frame that reports it.
std::string event_json(const touch::Event& event, const scene::Scene& scene, int frame);
/// Event as an OSC message.
std::string event_osc(const touch::Event& event, const scene::Scene& scene);

/// Numbers of datagrams.
struct SentCounts {
  std::uint64_t sent = 0, dropped = 0;
};

/// Sends to the receivers of a scene; never waits for them. One thread.
class EventOut {
 public:
  /// `scene` outlives it. Errors: those of DatagramSender::open(), with file and key.
  static Result<EventOut> open(const scene::Scene& scene);

  /// Sends an event. `json`: from event_json().
  void tell(const touch::Event& event, const std::string& json);
  /// Sends the people of a frame, if the scene asks for them.
  void tell(std::span<const plan::Person> people, int frame, double time_s);
  SentCounts json_counts() const { return counts(json_); }
  SentCounts osc_counts() const { return counts(osc_); }

 private:
  explicit EventOut(const scene::Scene& scene) : scene_(&scene) {}
  static SentCounts counts(const std::optional<stream::DatagramSender>& sender);

  const scene::Scene* scene_;
  std::optional<stream::DatagramSender> json_, osc_;
  bool people_ = false;
};

}  // namespace mixrig::session

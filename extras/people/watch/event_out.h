// SPDX-License-Identifier: Apache-2.0
// Tells other programs what happens: events and places of people as JSON and OSC, in UDP datagrams.
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

/// One line, as in events.jsonl; docs/reference/events.md has its keys. `frame`: number in which it
/// is told.
std::string event_json(const touch::Event& event, const scene::Scene& scene, int frame);
/// An OSC message of the same.
std::string event_osc(const touch::Event& event, const scene::Scene& scene);

/// Datagrams.
struct SentCounts {
  std::uint64_t sent = 0, dropped = 0;
};

/// Never waits for a receiver. One thread.
class EventOut {
 public:
  /// `scene` outlives it. Errors: those of DatagramSender::open(), with file and key.
  static Result<EventOut> open(const scene::Scene& scene);

  /// `json`: by event_json().
  void tell(const touch::Event& event, const std::string& json);
  /// Where the scene wants them, the people of a frame.
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

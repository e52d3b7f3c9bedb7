// SPDX-License-Identifier: Apache-2.0
// Turns gaps between two things over time into events.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace mixrig::touch {

enum class EventKind : std::uint8_t { kEnter, kStay, kLeave, kHit };
/// Kind of thing that the object touches.
enum class Against : std::uint8_t { kPerson, kObject, kRoom };
/// Part of the room that an object touches.
enum class RoomPart : std::uint8_t { kAny, kFloor, kWall, kFurniture };
/// Source of a gap's distance.
enum class Evidence : std::uint8_t {
  kSurface,  ///< surface that was seen
  kProxy,    ///< the back of a body that nothing sees, as a cylinder
  kShape,    ///< both are known shapes
};
std::string_view name(EventKind kind);
std::string_view name(Against against);
std::string_view name(RoomPart part);
std::string_view name(Evidence evidence);

/// Gap between two things in one frame.
struct Gap {
  double m = 0;                                    ///< negative: the depth of penetration
  double sigma_m = 0;                              ///< standard deviation of `m`
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();  ///< where they are nearest, world
  Evidence evidence = Evidence::kSurface;
};

struct Event {
  EventKind kind = EventKind::kEnter;
  Against against = Against::kPerson;
  Evidence evidence = Evidence::kSurface;
  int object = 0;  ///< number of the object
  int other = 0;   ///< id of the person, number of the other object, 0 for the room
  RoomPart part = RoomPart::kAny;
  double time_s = 0;  ///< when it happened; it may be reported a frame later
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();
  double depth_m = 0;  ///< depth of penetration; for kLeave the largest one
  double sigma_m = 0;
  double speed_m_s = 0;  ///< closing speed, for kEnter and kHit
};

struct ContactOptions {
  double least_m = 0.005;   ///< least penetration that counts; negative: a gap that counts
  double sure_sigmas = 1;   ///< least penetration in standard deviations
  int frames_to_enter = 2;  ///< frames of overlap in a row, in one of which the penetration counts
  double leave_m = 0.02;    ///< gap that counts as apart, in addition to sure_sigmas
  double leave_s = 0.12;    ///< time apart before kLeave
  double stay_s = 0.5;      ///< from one kStay to the next
  double hit_m_s = 0.5;     ///< least speed of a kHit
};

/// Contact of one pair. Allocates nothing except for `out`.
class Contact {
 public:
  Contact(Against against, int object, int other)
      : against_(against), object_(object), other_(other) {}
  Against against() const { return against_; }
  int object() const { return object_; }
  int other() const { return other_; }
  bool is_in() const { return in_; }

  /// Adds the gap of a frame; nullopt: the two are far from each other. With `is_hidden` nothing is
  /// known about this frame, and the state stays.
  void add(const std::optional<Gap>& gap, bool is_hidden, double time_s,
           const ContactOptions& options, std::vector<Event>& out);
  /// Ends the contact, since one of the two is gone.
  void end(double time_s, std::vector<Event>& out);

 private:
  struct Past {
    double time_s = 0, gap_m = 0;
  };
  void note(double time_s, double gap_m);
  double crossing_s() const;
  double closing_m_s() const;
  void wait_to_enter(const std::optional<Gap>& gap, bool counts, double time_s,
                     const ContactOptions& options, std::vector<Event>& out);
  Event event(EventKind kind, double time_s, const Gap& gap) const;

  Against against_;
  int object_, other_;
  bool in_ = false;
  int touching_frames_ = 0;
  bool counted_ = false;        ///< the penetration counted in one of these frames
  Event first_;                 ///< event that is not confirmed yet
  std::array<Past, 6> past_{};  ///< the newest first
  std::size_t known_ = 0;       ///< number of known entries of past_
  Gap last_;                    ///< last gap while they touch
  double deepest_m_ = 0, told_s_ = 0;
  std::optional<double> apart_since_s_;
};

}  // namespace mixrig::touch

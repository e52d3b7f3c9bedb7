// SPDX-License-Identifier: Apache-2.0
// Two things that touch and part, over time: gaps become events.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace mixrig::touch {

enum class EventKind : std::uint8_t { kEnter, kStay, kLeave, kHit };
/// What the object touches.
enum class Against : std::uint8_t { kPerson, kObject, kRoom };
/// What of the room.
enum class RoomPart : std::uint8_t { kAny, kFloor, kWall, kFurniture };
/// What tells.
enum class Evidence : std::uint8_t {
  kSurface,  ///< surface that was seen
  kProxy,    ///< the back of a body that nothing sees, as a cylinder
  kShape,    ///< both are known shapes
};
std::string_view name(EventKind kind);
std::string_view name(Against against);
std::string_view name(RoomPart part);
std::string_view name(Evidence evidence);

/// Between two things in one frame.
struct Gap {
  double m = 0;                                    ///< negative: the depth of penetration
  double sigma_m = 0;                              ///< of it
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
  double time_s = 0;  ///< of what happened; it may have been told a frame later
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();
  double depth_m = 0;  ///< of penetration; of kLeave the largest that was
  double sigma_m = 0;
  double speed_m_s = 0;  ///< at which the gap closed; of kEnter and kHit
};

struct ContactOptions {
  double least_m = 0.005;   ///< penetration that counts; negative: being so near does
  double sure_sigmas = 1;   ///< and in standard deviations
  int frames_to_enter = 2;  ///< in a row in which they overlap, one of them by what counts
  double leave_m = 0.02;    ///< gap that counts as apart, beside sure_sigmas
  double leave_s = 0.12;    ///< for which things are apart
  double stay_s = 0.5;      ///< from one kStay to the next
  double hit_m_s = 0.5;     ///< least speed of a kHit
};

/// One pair. Allocates nothing beyond what `out` needs.
class Contact {
 public:
  Contact(Against against, int object, int other)
      : against_(against), object_(object), other_(other) {}
  Against against() const { return against_; }
  int object() const { return object_; }
  int other() const { return other_; }
  bool is_in() const { return in_; }

  /// The gap of a frame; none: they are far from each other. With `is_hidden` nothing is known of
  /// this frame, and what was goes on.
  void add(const std::optional<Gap>& gap, bool is_hidden, double time_s,
           const ContactOptions& options, std::vector<Event>& out);
  /// One of them is gone.
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
  bool counted_ = false;        ///< one of these frames did
  Event first_;                 ///< while it is not believed
  std::array<Past, 6> past_{};  ///< the newest first
  std::size_t known_ = 0;       ///< of past_
  Gap last_;                    ///< while they touch
  double deepest_m_ = 0, told_s_ = 0;
  std::optional<double> apart_since_s_;
};

}  // namespace mixrig::touch

// SPDX-License-Identifier: Apache-2.0
#include "extras/people/touch/contact.h"

#include <algorithm>

namespace mixrig::touch {
namespace {

constexpr double kLongestStep_s = 0.2;  ///< over which a gap is taken to change evenly

}  // namespace

std::string_view name(EventKind kind) {
  constexpr std::string_view kNames[] = {"enter", "stay", "leave", "hit"};
  return kNames[static_cast<std::size_t>(kind)];
}
std::string_view name(Against against) {
  constexpr std::string_view kNames[] = {"person", "object", "room"};
  return kNames[static_cast<std::size_t>(against)];
}
std::string_view name(RoomPart part) {
  constexpr std::string_view kNames[] = {"", "floor", "wall", "furniture"};
  return kNames[static_cast<std::size_t>(part)];
}
std::string_view name(Evidence evidence) {
  constexpr std::string_view kNames[] = {"surface", "proxy", "shape"};
  return kNames[static_cast<std::size_t>(evidence)];
}

void Contact::note(double time_s, double gap_m) {
  std::move_backward(past_.begin(), past_.end() - 1, past_.end());
  past_[0] = {time_s, gap_m};
  known_ = std::min(known_ + 1, past_.size());
}

/// Time at which the gap became zero, between the last frame with a gap and the next; else the time
/// of the newest frame.
double Contact::crossing_s() const {
  for (std::size_t i = 0; i + 1 < known_; ++i) {
    const Past &after = past_[i], &before = past_[i + 1];
    if (before.gap_m < 0) continue;
    if (after.gap_m >= 0 || after.time_s - before.time_s > kLongestStep_s) break;
    return before.time_s +
           (after.time_s - before.time_s) * before.gap_m / (before.gap_m - after.gap_m);
  }
  return past_[0].time_s;
}

/// Mean closing speed over up to four known frames in a row; 0 where the gap does not close.
double Contact::closing_m_s() const {
  std::size_t oldest = 0;
  while (oldest + 1 < std::min<std::size_t>(known_, 4) &&
         past_[oldest].time_s - past_[oldest + 1].time_s < kLongestStep_s)
    ++oldest;
  const double step_s = past_[0].time_s - past_[oldest].time_s;
  return step_s > 0 ? std::max(0.0, (past_[oldest].gap_m - past_[0].gap_m) / step_s) : 0;
}

Event Contact::event(EventKind kind, double time_s, const Gap& gap) const {
  Event event;
  event.kind = kind, event.against = against_, event.evidence = gap.evidence;
  event.object = object_, event.other = other_;
  event.time_s = time_s, event.at_m = gap.at_m;
  event.depth_m = std::max(0.0, -gap.m), event.sigma_m = gap.sigma_m;
  return event;
}

void Contact::add(const std::optional<Gap>& gap, bool is_hidden, double time_s,
                  const ContactOptions& options, std::vector<Event>& out) {
  if (!gap && is_hidden) return;
  if (gap)
    note(time_s, gap->m);
  else
    known_ = 0;
  const double sure_m = gap ? options.sure_sigmas * gap->sigma_m : 0;
  const bool touching = gap && -gap->m >= std::max(options.least_m, sure_m);
  if (!in_) {
    wait_to_enter(gap, touching, time_s, options, out);
    return;
  }
  if (touching) last_ = *gap, deepest_m_ = std::max(deepest_m_, -gap->m);
  const bool apart = !gap || gap->m > options.leave_m + sure_m;
  if (!apart) {
    apart_since_s_.reset();
    if (time_s - told_s_ < options.stay_s) return;
    told_s_ = time_s;
    out.push_back(event(EventKind::kStay, time_s, last_));
    return;
  }
  if (!apart_since_s_) apart_since_s_ = time_s;
  if (time_s - *apart_since_s_ >= options.leave_s) end(*apart_since_s_, out);
}

/// Confirms that a contact begins: one frame alone may be an error of the key. The event has the
/// time of the first frame.
void Contact::wait_to_enter(const std::optional<Gap>& gap, bool counts, double time_s,
                            const ContactOptions& options, std::vector<Event>& out) {
  if (!gap || gap->m > std::max(0.0, -options.least_m)) {
    touching_frames_ = 0, counted_ = false;
    return;
  }
  counted_ |= counts;
  if (++touching_frames_ == 1) {
    first_ = event(EventKind::kEnter, crossing_s(), *gap);
    first_.speed_m_s = closing_m_s();
  }
  if (touching_frames_ < options.frames_to_enter || !counted_) return;
  in_ = true, touching_frames_ = 0, counted_ = false;
  last_ = *gap, deepest_m_ = std::max(first_.depth_m, -gap->m), told_s_ = time_s;
  apart_since_s_.reset();
  out.push_back(first_);
  if (first_.speed_m_s < options.hit_m_s) return;
  first_.kind = EventKind::kHit;
  out.push_back(first_);
}

void Contact::end(double time_s, std::vector<Event>& out) {
  if (in_) {
    Event left = event(EventKind::kLeave, time_s, last_);
    left.depth_m = deepest_m_;
    out.push_back(left);
  }
  in_ = false, touching_frames_ = 0, counted_ = false, known_ = 0;
}

}  // namespace mixrig::touch

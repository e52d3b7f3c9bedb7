// SPDX-License-Identifier: Apache-2.0
// Errors of tracked people's positions against the true ones.
#include "host/judge/measure/people.h"

#include <algorithm>
#include <cmath>

namespace mixrig::measure {
namespace {

constexpr double kChi2_95 = 5.991;  ///< of two values
constexpr double kNormal_975 = 1.95996;

/// Quantile of chi^2 over its degrees of freedom at a quantile of the normal distribution (Wilson
/// and Hilferty 1931).
double chi2_per_freedom(double freedom, double normal) {
  const double v = 2 / (9 * freedom);
  return std::pow(1 - v + normal * std::sqrt(v), 3);
}

double distance_m(const PersonThere& a, const PersonFound& b) {
  return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m);
}

/// e^T S^-1 e.
double mahalanobis2(const PersonThere& a, const PersonFound& b) {
  const double x = b.x_m - a.x_m, y = b.y_m - a.y_m;
  const double det = b.xx_m2 * b.yy_m2 - b.xy_m2 * b.xy_m2;
  return (b.yy_m2 * x * x - 2 * b.xy_m2 * x * y + b.xx_m2 * y * y) / det;
}

const PersonFound* find(std::span<const PersonFound> found, int id) {
  const auto at =
      std::find_if(found.begin(), found.end(), [id](const PersonFound& f) { return f.id == id; });
  return at == found.end() ? nullptr : &*at;
}

}  // namespace

void PeopleJudge::add(std::span<const PersonThere> there, std::span<const PersonFound> found,
                      const std::array<double, 2>& eye_m, double time_s) {
  pair(there, found);
  count_crossings(there, eye_m);
  tracks_ += found.size();
  false_ += found.size();
  for (const PersonThere& person : there) {
    Known& known = people_[person.number];
    const bool visible = person.visible_m2 >= kVisible_m2;
    known.visible_frames = visible ? known.visible_frames + 1 : 0;
    if (visible) count_occlusion(known, time_s);
    const PersonFound* track = find(found, known.id);
    const bool must = visible && known.visible_frames > kGrace;
    visible_ += must ? 1 : 0;
    missed_ += must && track == nullptr ? 1 : 0;
    if (track == nullptr) continue;
    --false_;
    const double error_mm = 1e3 * distance_m(person, *track);
    if (!visible) {
      ++hidden_;
      hidden_mm2_ += error_mm * error_mm;
      continue;
    }
    error_mm_.add(error_mm);
    square_mm2_ += error_mm * error_mm;
    const double d2 = mahalanobis2(person, *track);
    nees_ += d2;
    within_ += d2 <= kChi2_95 ? 1 : 0;
    if (!known.sampled_s || time_s - *known.sampled_s > kIndependent_s - 1e-6)
      known.sampled_s = time_s, ++samples_;
  }
}

/// Counts an occlusion of a visible person, and judges it as soon as a new person would have to be
/// found.
void PeopleJudge::count_occlusion(Known& known, double time_s) {
  const double since_s = time_s - known.seen_s;
  if (known.visible_frames == 1 && since_s >= kShortest_s && since_s <= kLongest_s)
    known.id_before = known.seen_id;
  if (known.visible_frames == kGrace && known.id_before != 0) {
    ++occlusions_;
    survived_ += known.id == known.id_before ? 1 : 0;
    known.id_before = 0;
  }
  known.seen_id = known.id, known.seen_s = time_s;
}

/// Pairs of the frame before first, then the nearest ones.
void PeopleJudge::pair(std::span<const PersonThere> there, std::span<const PersonFound> found) {
  std::vector<bool> taken(found.size(), false);
  const auto number_of = [&](const PersonFound* f) {
    return static_cast<std::size_t>(f - found.data());
  };
  std::vector<const PersonThere*> open;
  for (const PersonThere& person : there) {
    Known& known = people_[person.number];
    const PersonFound* track = find(found, known.id);
    if (track != nullptr && distance_m(person, *track) < kPair_m) {
      taken[number_of(track)] = true;
    } else {
      known.id = 0;
      open.push_back(&person);
    }
  }
  for (;;) {
    double least_m = kPair_m;
    const PersonThere* person = nullptr;
    const PersonFound* track = nullptr;
    for (const PersonThere* p : open)
      for (const PersonFound& f : found)
        if (!taken[number_of(&f)] && distance_m(*p, f) < least_m)
          least_m = distance_m(*p, f), person = p, track = &f;
    if (person == nullptr) return;
    taken[number_of(track)] = true;
    open.erase(std::find(open.begin(), open.end(), person));
    count_change(people_[person->number], person->number, track->id);
  }
}

void PeopleJudge::count_change(Known& known, int number, int id) {
  known.id = id;
  const auto before = person_of_.find(id);
  if (before != person_of_.end() && before->second != number)
    ++swaps_;
  else if (known.last_id != 0 && known.last_id != id)
    ++broken_;
  known.last_id = id;
  person_of_[id] = number;
}

void PeopleJudge::count_crossings(std::span<const PersonThere> there,
                                  const std::array<double, 2>& eye_m) {
  for (const PersonThere& a : there)
    for (const PersonThere& b : there) {
      if (a.number >= b.number || std::max(a.visible_m2, b.visible_m2) < kVisible_m2) continue;
      const double ax = a.x_m - eye_m[0], ay = a.y_m - eye_m[1];
      const double bx = b.x_m - eye_m[0], by = b.y_m - eye_m[1];
      if (ax * bx + ay * by <= 0) continue;  // one is behind the camera
      const bool left = ax * by - ay * bx > 0;
      const auto [at, is_new] = left_of_.try_emplace({a.number, b.number}, left);
      if (!is_new && at->second != left) ++crossings_, at->second = left;
    }
}

PeopleErrors PeopleJudge::errors() const {
  const auto share = [](auto part, auto whole) {
    return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
  };
  PeopleErrors e;
  e.judged = error_mm_.count();
  e.rms_mm = std::sqrt(share(square_mm2_, e.judged));
  e.p95_mm = error_mm_.quantile(0.95), e.max_mm = error_mm_.max();
  e.hidden_rms_mm = std::sqrt(share(hidden_mm2_, hidden_));
  e.nees = share(nees_, e.judged);
  e.within_95_pct = 100 * share(within_, e.judged);
  e.missed_pct = 100 * share(missed_, visible_);
  e.false_pct = 100 * share(false_, tracks_);
  e.swaps = swaps_, e.broken = broken_, e.crossings = crossings_;
  e.occlusions = occlusions_, e.survived = survived_, e.samples = samples_;
  if (samples_ > 0) {
    e.nees_low = 2 * chi2_per_freedom(2.0 * samples_, -kNormal_975);
    e.nees_high = 2 * chi2_per_freedom(2.0 * samples_, kNormal_975);
  }
  return e;
}

}  // namespace mixrig::measure

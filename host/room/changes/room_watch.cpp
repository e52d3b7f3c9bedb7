// SPDX-License-Identifier: Apache-2.0
#include "host/room/changes/room_watch.h"

#include <algorithm>
#include <cmath>

#include "hal/base/order_statistics.h"

namespace mixrig::model {
namespace {

constexpr double kLongestStep_s = 0.5;  ///< a gap between frames counts as no more
constexpr double kRound_s = 0.5;        ///< between looks for changes
/// Least number of cells of a change: 20 of 6 cm are 0.07 m^2 of surface.
constexpr int kFewestCells = 20;
/// Cells of one thing lie within kJoinReach voxels. A cell joins a thing after kJoinPart of the
/// time that a change must be seen; kFewestRipe of them must have been seen for all of it.
constexpr int kJoinReach = 2;
constexpr double kJoinPart = 0.75;
constexpr int kFewestRipe = 10;
/// Parts of one thing lie no further from each other.
constexpr double kOneThing_m = 0.25;
/// Largest motion that noise leaves in an unmoved thing, as a part of a depth's sigma.
constexpr double kNoisePart = 1.0 / 12;
/// Largest ratio between the numbers of cells of one thing, as appeared and as gone.
constexpr double kMostSizeRatio = 3;
constexpr double kFarthestMove_m = 6;
/// Largest distance of a shadow from the change that casts it.
constexpr double kShadow_m = 0.6;
constexpr std::size_t kMostFound = 256;
/// Least factor of light that counts, and share of the room off it where a lamp has changed.
constexpr double kLeastLight = 1.2, kLampShare = 0.3;
constexpr int kFewestPatches = 20;

}  // namespace

WatchOptions watch_options(double appeared_s) {
  WatchOptions options;
  const double share = appeared_s / options.appeared_s;
  options.appeared_s *= share, options.gone_s *= share, options.color_s *= share;
  return options;
}

RoomWatch::RoomWatch(const Eigen::AlignedBox3d& room_m, const geometry::DepthNoise& noise,
                     const WatchOptions& options)
    : options_(options),
      noise_(noise),
      sight_(noise),
      surfaces_(ChangeCells::Kind::kSurface, room_m),
      holes_(ChangeCells::Kind::kHole, room_m),
      lights_(room_m) {
  found_.reserve(kMostFound);
  members_.reserve(ChangeCells::kMostCells);
  visited_.reserve(ChangeCells::kMostCells);
  values_.reserve(ChangeCells::kMostCells);
}

bool RoomWatch::add(const WatchFrame& frame) {
  const double time_s = frame.time_s;
  const double dt_s = started_ ? std::clamp(time_s - last_s_, 0.0, kLongestStep_s) : 0;
  if (!started_) last_round_s_ = time_s;
  started_ = true;
  last_s_ = time_s;
  eye_m_ = frame.world_from_view.translation_m;
  sight_.see(frame);
  surfaces_.add(sight_, dt_s);
  holes_.add(sight_, dt_s);
  lights_.add(sight_, dt_s);
  news_ = false;
  find_lights(time_s, dt_s);
  if (time_s - last_round_s_ < kRound_s) return news_;
  last_round_s_ = time_s;
  find_changes(time_s);
  return news_;
}

void RoomWatch::find_changes(double time_s) {
  for (Found& f : found_) {
    f.box_m.setEmpty();
    f.held_s = f.against_s = 0;
    f.cells = 0;
  }
  cluster(holes_, options_.gone_s, ChangeKind::kGone, time_s);
  cluster(surfaces_, options_.appeared_s, ChangeKind::kAppeared, time_s);
  finish_round();
  pair_up();
  find_colors(time_s);
}

void RoomWatch::cluster(ChangeCells& evidence, double least_s, ChangeKind kind, double time_s) {
  visited_.assign(evidence.cells().size(), 0);
  for (std::size_t i = 0; i < evidence.cells().size(); ++i) {
    const ChangeCell& cell = evidence.cells()[i];
    if (cell.slot < 0 || cell.held_s < least_s || visited_[i] != 0) continue;
    grow(evidence, i, kJoinPart * least_s);
    if (count_ripe(evidence, least_s) >= kFewestRipe) take(evidence, kind, time_s);
  }
}

/// Collects in members_ the cells that are connected with `seed`, each held for `least_s`.
void RoomWatch::grow(ChangeCells& evidence, std::size_t seed, double least_s) {
  members_.clear();
  members_.push_back(seed);
  visited_[seed] = 1;
  for (std::size_t next = 0; next < members_.size(); ++next)
    evidence.around(evidence.cells()[members_[next]].point_m.cast<double>(), kJoinReach,
                    [&](std::size_t i) {
                      if (visited_[i] != 0 || evidence.cells()[i].held_s < least_s) return true;
                      visited_[i] = 1;
                      members_.push_back(i);
                      return true;
                    });
}

int RoomWatch::count_ripe(const ChangeCells& evidence, double least_s) const {
  return static_cast<int>(std::count_if(members_.begin(), members_.end(), [&](std::size_t i) {
    return evidence.cells()[i].held_s >= least_s;
  }));
}

double RoomWatch::unrest_m(const ChangeCells& evidence) {
  values_.clear();
  for (const std::size_t i : members_) {
    const ChangeCell& cell = evidence.cells()[i];
    values_.push_back(cell.weight > 0 ? cell.covariance_m2 / cell.weight : 0);
  }
  return std::sqrt(std::max(0.0, double{upper_median_in_place(std::span(values_))}));
}

bool RoomWatch::is_still(double unrest_m, const Eigen::Vector3d& center_m) const {
  const double sigma_m = noise_.sigma_m((center_m - eye_m_).norm());
  return unrest_m <= std::max(options_.still_m, kNoisePart * sigma_m);
}

/// Makes the cluster a change, or part of the one that its cells belonged to before.
void RoomWatch::take(ChangeCells& evidence, ChangeKind kind, double time_s) {
  if (static_cast<int>(members_.size()) < kFewestCells) return;
  Eigen::AlignedBox3d box_m;
  double first_s = time_s, seen_s = 0, held_s = 0, against_s = 0;
  int known = 0;
  for (const std::size_t i : members_) {
    const ChangeCell& cell = evidence.cells()[i];
    box_m.extend(cell.point_m.cast<double>());
    first_s = std::min(first_s, cell.first_s), seen_s = std::max(seen_s, cell.seen_s);
    held_s += double{cell.held_s}, against_s += double{cell.against_s};
    if (cell.change != 0 && (known == 0 || cell.change < known)) known = cell.change;
  }
  if (known == 0) known = beside(box_m, kind);
  const double unrest = kind == ChangeKind::kAppeared ? unrest_m(evidence) : 0;
  if (known == 0) {
    if (!is_still(unrest, box_m.center()) || found_.size() == kMostFound) return;
    add_found(kind, first_s, time_s);
    known = static_cast<int>(found_.size());
  }
  for (const std::size_t i : members_) evidence.cells()[i].change = known;
  Found& f = number(known);
  f.box_m.extend(box_m);
  f.held_s += held_s, f.against_s += against_s;
  f.cells += static_cast<int>(members_.size());
  f.change.seen_s = std::max(f.change.seen_s, seen_s);
  f.change.unrest_m = unrest;
}

/// Number of the change that a cluster is another part of, though no cell joins them; 0: none.
int RoomWatch::beside(const Eigen::AlignedBox3d& box_m, ChangeKind kind) const {
  for (std::size_t i = 0; i < found_.size(); ++i) {
    const Found& f = found_[i];
    const bool same = f.change.kind == kind ||
                      (kind == ChangeKind::kAppeared && f.change.kind == ChangeKind::kMoved);
    if (same && f.cells > 0 && !f.change.accepted && f.box_m.exteriorDistance(box_m) < kOneThing_m)
      return static_cast<int>(i) + 1;
  }
  return 0;
}

RoomWatch::Found& RoomWatch::add_found(ChangeKind kind, double since_s, double time_s) {
  Found& f = found_.emplace_back();
  f.change.kind = kind;
  f.change.since_s = since_s, f.change.found_s = f.change.seen_s = time_s;
  news_ = true;
  return f;
}

void RoomWatch::finish_round() {
  for (Found& f : found_) {
    const bool spatial =
        f.change.kind != ChangeKind::kLights && f.change.kind != ChangeKind::kColor;
    if (!spatial || f.change.accepted) continue;
    f.change.over = f.cells == 0;
    if (f.change.over) continue;
    f.change.center_m = f.box_m.center();
    f.change.size_m = f.box_m.sizes().array() + surfaces_.voxel_m();
    f.change.certainty = f.held_s / (f.held_s + f.against_s);
  }
}

/// Joins an appeared and a vanished thing of about one size to one thing that moved.
void RoomWatch::pair_up() {
  for (Found& f : found_) {
    if (f.change.kind == ChangeKind::kMoved && !f.change.accepted)
      f.change.from_m = number(f.partner).change.center_m;
    if (f.change.kind != ChangeKind::kAppeared || f.change.over || f.change.accepted) continue;
    double best = kMostSizeRatio;
    for (std::size_t i = 0; i < found_.size(); ++i) {
      const Found& g = found_[i];
      if (g.change.kind != ChangeKind::kGone || g.hidden || g.change.over || g.change.accepted)
        continue;
      const double ratio = static_cast<double>(f.cells) / g.cells;
      const double unlike = std::max(ratio, 1 / ratio);
      if (unlike > best || (f.change.center_m - g.change.center_m).norm() > kFarthestMove_m)
        continue;
      best = unlike;
      f.partner = static_cast<int>(i) + 1;
    }
    if (f.partner == 0) continue;
    Found& gone = number(f.partner);
    gone.hidden = true;
    f.change.kind = ChangeKind::kMoved;
    f.change.from_m = gone.change.center_m;
    f.change.since_s = std::min(f.change.since_s, gone.change.since_s);
    f.told = false;
    news_ = true;
  }
}

void RoomWatch::find_lights(double time_s, double dt_s) {
  const LightState& state = lights_.state();
  if (state.patches < kFewestPatches) return;
  const bool lamp = state.uneven_share > kLampShare;
  const bool off = lamp || state.factor.log().abs().maxCoeff() > std::log(kLeastLight);
  lights_off_s_ = off ? lights_off_s_ + dt_s : 0;
  lights_on_s_ = off ? 0 : lights_on_s_ + dt_s;
  if (lights_change_ == 0 && lights_off_s_ >= options_.lights_s) {
    if (found_.size() == kMostFound) return;
    add_found(ChangeKind::kLights, time_s - lights_off_s_, time_s);
    lights_change_ = static_cast<int>(found_.size());
  }
  if (lights_change_ == 0) return;
  RoomChange& change = number(lights_change_).change;
  if (off) {
    change.factor = state.factor, change.common = !lamp;
    change.certainty = 1 - state.uneven_share, change.seen_s = time_s;
  }
  if (lights_on_s_ < options_.lights_s) return;
  change.over = true;
  lights_change_ = 0;
}

/// Finds changes of colour, but none within kShadow_m of another change or while a lamp differs.
void RoomWatch::find_colors(double time_s) {
  if (lights_.state().uneven_share > kLampShare) return;
  const double patch_m = lights_.patch_m();
  for (std::size_t i = 0; i < lights_.patches().size(); ++i) {
    LightWatch::Patch& patch = lights_.patches()[i];
    if (patch.seen_s < 0 || patch.off_s < options_.color_s || patch.change != 0) continue;
    const Eigen::Vector3d at_m = lights_.center_m(i);
    if (is_explained(at_m) || found_.size() == kMostFound) continue;
    Found* f = nullptr;
    for (Found& other : found_)
      if (other.change.kind == ChangeKind::kColor && !other.change.over &&
          (other.change.center_m - at_m).cwiseAbs().maxCoeff() <=
              0.5 * other.change.size_m.maxCoeff() + patch_m)
        f = &other;
    if (f == nullptr) {
      f = &add_found(ChangeKind::kColor, time_s - patch.off_s, time_s);
      f->change.factor = (patch.log_factor.exp() / lights_.state().factor).eval();
      f->change.center_m = at_m, f->change.size_m.setConstant(patch_m);
      f->change.certainty = 1;
    }
    patch.change = static_cast<int>(f - found_.data()) + 1;
    Eigen::AlignedBox3d box_m(f->change.center_m - 0.5 * f->change.size_m,
                              f->change.center_m + 0.5 * f->change.size_m);
    box_m.extend(at_m - Eigen::Vector3d::Constant(0.5 * patch_m));
    box_m.extend(at_m + Eigen::Vector3d::Constant(0.5 * patch_m));
    f->change.center_m = box_m.center(), f->change.size_m = box_m.sizes();
    f->change.seen_s = patch.seen_s;
  }
}

bool RoomWatch::is_explained(const Eigen::Vector3d& place_m) const {
  bool any = false;
  const auto stop = [&](std::size_t) { return !(any = true); };
  const int reach = static_cast<int>(std::ceil(kShadow_m / surfaces_.voxel_m()));
  surfaces_.around(place_m, reach, stop);
  holes_.around(place_m, reach, stop);
  for (const Found& f : found_)
    any |= f.change.kind != ChangeKind::kLights && f.change.kind != ChangeKind::kColor &&
           f.change.accepted && f.box_m.exteriorDistance(place_m) < kShadow_m;
  return any;
}

std::vector<RoomChange> RoomWatch::changes() const {
  std::vector<RoomChange> out;
  for (const Found& f : found_)
    if (!f.hidden) out.push_back(f.change);
  return out;
}

std::vector<RoomChange> RoomWatch::news() {
  std::vector<RoomChange> out;
  for (Found& f : found_)
    if (!f.hidden && !std::exchange(f.told, true)) out.push_back(f.change);
  return out;
}

bool RoomWatch::any_open() const {
  const auto open = [](const Found& f) {
    return f.cells > 0 && !f.change.over && !f.change.accepted;
  };
  return std::any_of(found_.begin(), found_.end(), open);
}

bool RoomWatch::is_open(const ChangeCell& cell) const {
  if (cell.slot < 0 || cell.change == 0) return false;
  const RoomChange& change = found_[static_cast<std::size_t>(cell.change - 1)].change;
  return !change.over && !change.accepted;
}

std::vector<Eigen::Vector3d> RoomWatch::open_places(ChangeCells::Kind kind) const {
  const ChangeCells& evidence = kind == ChangeCells::Kind::kSurface ? surfaces_ : holes_;
  std::vector<Eigen::Vector3d> places;
  for (const ChangeCell& cell : evidence.cells())
    if (is_open(cell)) places.push_back(cell.point_m.cast<double>());
  return places;
}

bool RoomWatch::is_open(ChangeCells::Kind kind, const Eigen::Vector3d& world_m, int reach) const {
  const ChangeCells& evidence = kind == ChangeCells::Kind::kSurface ? surfaces_ : holes_;
  bool found = false;
  evidence.around(world_m, reach, [&](std::size_t i) {
    found = is_open(evidence.cells()[i]);
    return !found;
  });
  return found;
}

double RoomWatch::seen_share() const {
  int open = 0, seen = 0;
  for (const ChangeCells* evidence : {&surfaces_, &holes_})
    for (const ChangeCell& cell : evidence->cells()) {
      if (!is_open(cell)) continue;
      ++open;
      seen += cell.seen_s == last_s_ ? 1 : 0;
    }
  return open > 0 ? static_cast<double>(seen) / open : 0;
}

void RoomWatch::accept() {
  for (ChangeCells* evidence : {&surfaces_, &holes_})
    for (ChangeCell& cell : evidence->cells())
      if (is_open(cell)) evidence->free(cell);
  for (Found& f : found_)
    if (f.cells > 0 && !f.change.over) f.change.accepted = true;
  lights_.forget();
}

}  // namespace mixrig::model

// SPDX-License-Identifier: Apache-2.0
// Compares events of a studio take with the true surfaces of its people: boxes on a person's way,
// and boxes passed at 150 mm. usage: touch_study TAKE SCENARIO RIG SEED PEOPLE FRAMES
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "extras/people/touch/touch_watch.h"
#include "host/run/loop/run.h"
#include "host/run/session/session.h"
#include "studio/true_bodies.h"

namespace mixrig {
namespace {

constexpr double kPass_m = 0.15;
const Eigen::Vector3d kHalf_m(0.15, 0.15, 0.6);
constexpr int kPlaces = 8;

struct StudyBox {
  geometry::Pose world_from_box;  ///< pose of the box's middle
  bool is_passed = false;         ///< people pass it at a distance of kPass_m
};

struct Found {
  touch::Event event;
  int frame = 0;
};

/// Depth that the key showed in a frame, and the view.
struct Seen {
  Image<float> depth_m;
  geometry::Pinhole view;
  geometry::Pose view_from_world;

  bool shows(const Eigen::Vector3d& at_m) const {
    constexpr int kAround_px = 2;
    constexpr double kSame_m = 0.04;
    const Eigen::Vector3d p = view_from_world * at_m;
    if (p.z() < 0.1) return false;
    const Eigen::Vector2d px = view.project(p);
    const int cx = static_cast<int>(std::lround(px.x())),
              cy = static_cast<int>(std::lround(px.y()));
    for (int y = cy - kAround_px; y <= cy + kAround_px; ++y)
      for (int x = cx - kAround_px; x <= cx + kAround_px; ++x)
        if (x >= 0 && y >= 0 && x < depth_m.width() && y < depth_m.height() &&
            std::abs(depth_m.at(x, y) - p.z()) < kSame_m)
          return true;
    return false;
  }
};

/// Follows people, and watches the boxes.
class StudySink final : public output::CompositeSink {
 public:
  StudySink(const std::vector<StudyBox>& boxes, const geometry::DepthNoise& noise,
            std::vector<Found>& found, std::vector<Seen>& seen)
      : watch_(shapes(boxes)), noise_(noise), found_(found), seen_(seen) {
    for (const StudyBox& box : boxes) poses_.push_back(box.world_from_box);
  }
  std::string_view name() const override { return "study"; }
  render::OutputMask wanted(int) const override {
    return render::kSegmentedDepth | render::kMixedDepth;
  }
  Result<void> write(const output::CompositePtr& c) override {
    const plan::SegmentedView seen{c->images.segmented_depth_m, c->view, c->world_from_target,
                                   c->images.mixed_depth_m};
    const double time_s = c->capture->time_s;
    const auto people = tracker_.add(seen, time_s);
    seen_.push_back(
        {c->images.segmented_depth_m, c->view, geometry::inverse(c->world_from_target)});
    if (const char* const which = std::getenv("TOUCH_STUDY_BOX")) {
      const auto i = static_cast<std::size_t>(std::atoi(which));
      const auto gaps =
          gaps_.measure(watch_.shapes()[i], poses_[i], {seen, people, poses_, noise_, time_s});
      for (std::size_t k = 0; k < gaps.size(); ++k)
        if (gaps[k])
          std::printf("frame %d person %d at %.2f %.2f: gap %.0f +- %.0f mm at %.2f %.2f %.2f\n",
                      c->capture->number, people[k].id, people[k].on_floor_m.x(),
                      people[k].on_floor_m.y(), 1e3 * gaps[k]->m, 1e3 * gaps[k]->sigma_m,
                      gaps[k]->at_m.x(), gaps[k]->at_m.y(), gaps[k]->at_m.z());
    }
    for (const touch::Event& e : watch_.add({seen, people, poses_, noise_, time_s}))
      if (e.against == touch::Against::kPerson) found_.push_back({e, c->capture->number});
    return {};
  }
  Result<void> finish() override { return {}; }

 private:
  static std::vector<touch::Shape> shapes(const std::vector<StudyBox>& boxes) {
    const Eigen::Vector3f half = kHalf_m.cast<float>();
    return std::vector<touch::Shape>(boxes.size(), touch::box_shape({-half, half}));
  }
  touch::TouchWatch watch_;
  touch::SurfaceGaps gaps_;
  plan::PeopleTracker tracker_;
  std::vector<geometry::Pose> poses_;
  geometry::DepthNoise noise_;
  std::vector<Found>& found_;
  std::vector<Seen>& seen_;
};

struct Body {
  std::vector<Eigen::Vector3f> surface_m;
  Eigen::AlignedBox3d box_m;
};
using Frames = std::vector<std::vector<Body>>;  ///< [frame][person]

/// Distance of a body from a box; none if it is certainly at least `least_m`.
std::optional<studio::BoxDistance> distance_of(const Body& body, const geometry::Pose& box,
                                               const Eigen::Vector3d& half_m, double least_m) {
  if (body.box_m.exteriorDistance(box.translation_m) - half_m.norm() >= least_m) return {};
  return studio::distance_to_box(body.surface_m, box, half_m);
}

double least_m(const Frames& frames, const geometry::Pose& box) {
  double least = 1e9;
  for (const auto& people : frames)
    for (const Body& body : people)
      if (const auto d = distance_of(body, box, kHalf_m, least)) least = std::min(least, d->m);
  return least;
}

geometry::Pose box_at(const Eigen::Vector2d& at_m, double yaw_rad) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ())),
          {at_m.x(), at_m.y(), kHalf_m.z()}};
}

/// Boxes in pairs: one on the mean ellipse of the first person's way, one farther in along the same
/// ray, so far that everybody passes it at kPass_m.
std::vector<StudyBox> boxes_of(const Frames& frames) {
  std::vector<StudyBox> boxes;
  Eigen::AlignedBox2d way;
  std::vector<Eigen::Vector2d> places;
  for (const auto& people : frames) {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (const auto& p : people[0].surface_m) sum += p;
    places.emplace_back(
        (sum / static_cast<float>(people[0].surface_m.size())).head<2>().cast<double>());
    way.extend(places.back());
  }
  const Eigen::Vector2d middle = way.center();
  for (int i = 0; i < kPlaces; ++i) {
    const double angle = 2 * std::numbers::pi * (i + 0.5) / kPlaces;
    const Eigen::Vector2d ray(std::cos(angle), std::sin(angle));
    const Eigen::Vector2d on_way =
        *std::max_element(places.begin(), places.end(), [&](const auto& a, const auto& b) {
          return (a - middle).normalized().dot(ray) < (b - middle).normalized().dot(ray);
        });
    boxes.push_back({box_at(on_way, angle), false});
    double near_m = 0, far_m = 1.5;  // distance inwards from the way, up to beyond the middle
    if (least_m(frames, box_at(on_way - far_m * ray, angle)) < kPass_m)
      for (double d = 0.3; d < 1.5 && far_m == 1.5; d += 0.05)
        if (least_m(frames, box_at(on_way - d * ray, angle)) > kPass_m) far_m = d;
    if (far_m == 1.5) continue;  // no such place exists
    near_m = far_m - 0.05;
    for (int k = 0; k < 6; ++k) {
      const double d = 0.5 * (near_m + far_m);
      (least_m(frames, box_at(on_way - d * ray, angle)) > kPass_m ? far_m : near_m) = d;
    }
    boxes.push_back({box_at(on_way - far_m * ray, angle), true});
  }
  return boxes;
}

struct TrueContact {
  double time_s = 0;
  Eigen::Vector3d at_m;
  std::size_t box = 0, person = 0;
};

std::vector<TrueContact> true_contacts(const Frames& frames, int first,
                                       const std::vector<StudyBox>& boxes) {
  std::vector<TrueContact> out;
  for (std::size_t b = 0; b < boxes.size(); ++b)
    for (std::size_t p = 0; p < frames[0].size(); ++p) {
      double before_m = -1;  // a person who is inside from the first frame on has no first contact
      for (std::size_t f = 0; f < frames.size(); ++f) {
        const auto d = distance_of(frames[f][p], boxes[b].world_from_box, kHalf_m, 0.3)
                           .value_or(studio::BoxDistance{1, {}});
        const double time_s = (static_cast<double>(f) + first - 1) / studio::kFrameRate_hz;
        if (before_m > 0 && d.m <= 0)
          out.push_back({time_s - d.m / (d.m - before_m) / studio::kFrameRate_hz, d.at_m, b, p});
        before_m = d.m;
      }
    }
  return out;
}

double quantile_of(std::vector<double> values, double q) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1) + 0.5)];
}

/// Counts of the contacts whose first place the camera sees, or of the other contacts.
struct Tally {
  int contacts = 0, missed = 0, within = 0, both = 0, by_proxy = 0;
  std::vector<double> frames, gap_mm, place_mm;

  void print(const char* what) const {
    std::printf(
        "%s: %d contacts, %d missed, %d within a frame and 50 mm, %d within a frame, %d by proxy; "
        "off by %.2f frames in the median, 95 %% %.2f; true gap then %.0f mm, 95 %% %.0f; place "
        "off "
        "the surface %.0f mm, 95 %% %.0f\n",
        what, contacts, missed, both, within, by_proxy, quantile_of(frames, 0.5),
        quantile_of(frames, 0.95), quantile_of(gap_mm, 0.5), quantile_of(gap_mm, 0.95),
        quantile_of(place_mm, 0.5), quantile_of(place_mm, 0.95));
  }
};

void judge(const Frames& frames, int first, const std::vector<StudyBox>& boxes,
           const std::vector<Found>& found, const std::vector<Seen>& seen, double first_s) {
  const auto contacts = true_contacts(frames, first, boxes);
  const auto frame_of = [&](double time_s) {
    return static_cast<std::size_t>(
        std::clamp(std::lround(time_s * studio::kFrameRate_hz) + 1 - first, 0L,
                   static_cast<long>(frames.size()) - 1));
  };
  std::vector<bool> used(found.size(), false);
  Tally tallies[2];
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const TrueContact& c = contacts[k];
    // Hands swing in and out: a contact within 0.3 s of another one belongs to it.
    const bool again = k > 0 && contacts[k - 1].box == c.box &&
                       contacts[k - 1].person == c.person &&
                       c.time_s - contacts[k - 1].time_s < 0.3;
    if (c.time_s < first_s || again) continue;
    const std::size_t then = frame_of(c.time_s);
    const bool shown =
        seen[then].shows(c.at_m) || seen[std::min(then + 1, seen.size() - 1)].shows(c.at_m);
    Tally& tally = tallies[shown ? 0 : 1];
    ++tally.contacts;
    std::size_t best = found.size();
    double least_s = 0.6;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const touch::Event& e = found[i].event;
      const double off_s = std::abs(e.time_s - c.time_s);
      if (e.kind == touch::EventKind::kEnter && e.object == static_cast<int>(c.box) && !used[i] &&
          off_s < least_s)
        least_s = off_s, best = i;
    }
    std::printf("box %zu person %zu at %.2f s (%.2f %.2f %.2f), %s: ", c.box, c.person, c.time_s,
                c.at_m.x(), c.at_m.y(), c.at_m.z(), shown ? "seen" : "unseen");
    if (best == found.size()) {
      ++tally.missed;
      std::printf("missed\n");
      continue;
    }
    used[best] = true;
    const touch::Event& e = found[best].event;
    const std::vector<Eigen::Vector3f>& surface = frames[frame_of(e.time_s)][c.person].surface_m;
    const double gap_m = studio::distance_to_box(surface, boxes[c.box].world_from_box, kHalf_m).m;
    const double off_m =
        studio::distance_to_box(surface, {Eigen::Quaterniond::Identity(), e.at_m}, {0, 0, 0}).m;
    const double late = (e.time_s - c.time_s) * studio::kFrameRate_hz;
    tally.frames.push_back(std::abs(late));
    tally.gap_mm.push_back(1e3 * std::abs(gap_m)), tally.place_mm.push_back(1e3 * off_m);
    tally.within += std::abs(late) <= 1;
    tally.both += std::abs(late) <= 1 && (e.at_m - c.at_m).norm() <= 0.05;
    tally.by_proxy += e.evidence == touch::Evidence::kProxy;
    std::printf(
        "%+.2f frames, true gap %.0f mm, place off %.0f mm, from the first place %.0f mm, %s\n",
        late, 1e3 * gap_m, 1e3 * off_m, 1e3 * (e.at_m - c.at_m).norm(),
        std::string(touch::name(e.evidence)).c_str());
  }
  int false_near = 0, false_way = 0, near = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i].event.kind != touch::EventKind::kEnter || used[i]) continue;
    const bool passed = boxes[static_cast<std::size_t>(found[i].event.object)].is_passed;
    // Somebody may already be in the box, or enter it again after a swing.
    double least = 1e9;
    const auto at = static_cast<std::size_t>(
        std::clamp(std::lround(found[i].event.time_s * studio::kFrameRate_hz + 1 - first), 0L,
                   static_cast<long>(frames.size()) - 1));
    for (const Body& body : frames[at])
      least = std::min(
          least, studio::distance_to_box(
                     body.surface_m,
                     boxes[static_cast<std::size_t>(found[i].event.object)].world_from_box, kHalf_m)
                     .m);
    if (least <= 0) continue;
    ++(passed ? false_near : false_way);
    std::printf(
        "false: box %d person %d at %.2f s %.2f %.2f %.2f, true gap %.0f mm, depth %.0f mm, "
        "%s\n",
        found[i].event.object, found[i].event.other, found[i].event.time_s, found[i].event.at_m.x(),
        found[i].event.at_m.y(), found[i].event.at_m.z(), 1e3 * least, 1e3 * found[i].event.depth_m,
        std::string(touch::name(found[i].event.evidence)).c_str());
  }
  for (const StudyBox& box : boxes) near += box.is_passed;
  tallies[0].print("first place seen");
  tallies[1].print("first place not seen");
  std::printf("%d boxes passed at 150 mm in %zu frames: %d false; others %d false\n", near,
              frames.size(), false_near, false_way);
}

Result<void> study(int argc, char** argv) {
  if (argc < 7) return Error{ErrorCode::kUsage, "TAKE SCENARIO RIG SEED PEOPLE FRAMES"};
  studio::StudioOptions options;
  MIXRIG_ASSIGN(options.scenario, studio::parse_scenario(argv[2]));
  MIXRIG_ASSIGN(options.rig, studio::parse_rig(argv[3]));
  options.seed = static_cast<unsigned>(std::atoi(argv[4]));
  options.people = std::atoi(argv[5]), options.frames = std::atoi(argv[6]);
  const studio::TrueBodies bodies(options);
  const int first = std::min(25, options.frames / 2) + 1;
  Frames frames;
  for (int f = first; f <= options.frames; ++f) {
    auto& people = frames.emplace_back();
    for (auto& surface : bodies.surfaces(f)) {
      Body& body = people.emplace_back();
      for (const auto& p : surface) body.box_m.extend(p.cast<double>());
      body.surface_m = std::move(surface);
    }
  }
  const std::vector<StudyBox> boxes = boxes_of(frames);
  for (std::size_t i = 0; i < boxes.size(); ++i)
    std::printf("box %zu at %.2f %.2f%s\n", i, boxes[i].world_from_box.translation_m.x(),
                boxes[i].world_from_box.translation_m.y(), boxes[i].is_passed ? ", passed" : "");
  SystemClock clock;
  session::SessionOptions session_options;
  session_options.scene = std::string(argv[1]) + "/scene.toml";
  session_options.source = std::string("take:") + argv[1];
  MIXRIG_ASSIGN(const auto session, session::open_session(session_options));
  std::vector<Found> found;
  std::vector<Seen> seen;
  session::RunOptions run_options;
  run_options.judge = false, run_options.watch_room = false;
  session::RunParts parts;
  parts.sinks.push_back(std::make_unique<StudySink>(boxes, session->setup.noise, found, seen));
  MIXRIG_TRY(session::run(*session, run_options, clock, {}, std::move(parts)));
  constexpr double kToBelieve_s = 0.3;  // time until people who appear inside a box are believed
  judge(frames, first, boxes, found, seen, (first - 1) / studio::kFrameRate_hz + kToBelieve_s);
  return {};
}

}  // namespace
}  // namespace mixrig

int main(int argc, char** argv) {
  const auto done = mixrig::study(argc, argv);
  if (!done) std::fprintf(stderr, "touch_study: %s\n", done.error().context.c_str());
  return done ? 0 : 1;
}

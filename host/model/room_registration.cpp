// SPDX-License-Identifier: Apache-2.0
#include "host/model/room_registration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "hal/base/angles.h"
#include "hal/base/order_statistics.h"
#include "host/model/registration_guesses.h"
#include "host/model/room_places.h"
#include "host/model/room_planes.h"
#include "host/model/sphere_areas.h"

namespace mixrig::model {
namespace {

using Eigen::Vector3d;
using geometry::Pose;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr double kCoarseStep_rad = 9 * kDeg, kMiddleStep_rad = 5 * kDeg, kFineStep_rad = 2 * kDeg;
constexpr double kCoarseGate_m = 0.06, kFineGate_m = 0.02;
constexpr double kApart_m = 0.1, kApart_rad = 3 * kDeg;
constexpr std::size_t kMostAnswers = 12;  ///< that are refined
constexpr double kLeastOverlap = 0.2, kLeastAgreeing = 0.7, kLeastOfKnown = 0.6;
constexpr double kNearlyAsGood = 0.9;  ///< a tenth of a room may have changed
constexpr double kColorSigmas = 3;
constexpr double kWorthRefining = 0.75;   ///< of the evidence of the best
constexpr double kPatch_rad = 10 * kDeg;  ///< whose errors are taken as one
constexpr double kNear_m = 0.75, kNear_rad = 25 * kDeg;
/// Least share of the places whose normals hold a direction of the translation.
constexpr double kLeastHold = 0.01;

/// One direction of looking: places of one room in the other's panorama.
struct Side {
  const Panorama* panorama;       ///< that is looked at
  std::vector<RoomPlace> places;  ///< of the other room
  bool of_b = false;              ///< places
};
using Sides = std::array<Side, 2>;

struct Evidence {
  int places = 0, agree = 0, against = 0, hidden = 0;
  double of_all() const { return places > 0 ? 1.0 * (agree - against) / places : 0; }
  double overlap() const { return places > 0 ? 1.0 * (agree + against) / places : 0; }
  double agreeing() const { return agree + against > 0 ? 1.0 * agree / (agree + against) : 0; }
};

struct Answer {
  Pose a_from_b;
  Evidence evidence;
  double color = 0;
};

bool same(const Pose& p, const Pose& q) {
  return (p.translation_m - q.translation_m).norm() < kApart_m &&
         p.rotation.angularDistance(q.rotation) < kApart_rad;
}

bool is_near(const Pose& p, const Pose& q) {
  return (p.translation_m - q.translation_m).norm() < kNear_m &&
         p.rotation.angularDistance(q.rotation) < kNear_rad;
}

Pose to_other(const Side& side, const Pose& a_from_b) {
  return side.of_b ? a_from_b : geometry::inverse(a_from_b);
}

Sides sides_of(const Panorama& a, const Panorama& b, double step_rad) {
  return {Side{&a, places_of(b, step_rad), true}, Side{&b, places_of(a, step_rad), false}};
}

/// Calls with place, its pose to the other room and what is seen, every place of both sides.
template <typename Body>
void look_all(const Sides& sides, const Pose& a_from_b, double gate_m, const Body& body) {
  for (const Side& side : sides) {
    const Pose pose = to_other(side, a_from_b);
    const Eigen::Matrix3d turn = pose.rotation.toRotationMatrix();
    for (std::size_t i = 0; i < side.places.size(); ++i) {
      const RoomPlace& place = side.places[i];
      const Vector3d at_m = turn * place.at_m + pose.translation_m, normal = turn * place.normal;
      body(side, i, at_m, normal, look(*side.panorama, at_m, normal, place.sigma_m, gate_m));
    }
  }
}

Evidence evidence_of(const Sides& sides, const Pose& a_from_b, double gate_m) {
  Evidence e;
  look_all(sides, a_from_b, gate_m,
           [&](const Side&, std::size_t, const Vector3d&, const Vector3d&, const Seen& seen) {
             ++e.places;
             e.agree += seen.sight == Sight::kAgrees;
             e.against += seen.sight == Sight::kAgainst;
             e.hidden += seen.sight == Sight::kHidden;
           });
  return e;
}

/// Correlation of the colours of places with what the other room shows there, each channel around
/// its mean. 0 where either has one colour.
double color_agreement(const Sides& sides, const Pose& a_from_b) {
  std::vector<std::array<Eigen::Vector3f, 2>> pairs;
  Eigen::Vector3d mean0(0, 0, 0), mean1(0, 0, 0);
  look_all(sides, a_from_b, kFineGate_m,
           [&](const Side& side, std::size_t i, const Vector3d&, const Vector3d&, const Seen& s) {
             if (s.sight != Sight::kAgrees) return;
             Eigen::Vector3f own = side.places[i].color, other = s.color;
             if (own.isZero() || other.isZero()) return;
             if (side.of_b) std::swap(own, other);
             pairs.push_back({own, other});
             mean0 += own.cast<double>(), mean1 += other.cast<double>();
           });
  if (pairs.size() < 10) return 0;
  mean0 /= static_cast<double>(pairs.size()), mean1 /= static_cast<double>(pairs.size());
  double s00 = 0, s11 = 0, s01 = 0;
  for (const auto& [p, q] : pairs) {
    const Eigen::Vector3d u = p.cast<double>() - mean0, v = q.cast<double>() - mean1;
    s00 += u.squaredNorm(), s11 += v.squaredNorm(), s01 += u.dot(v);
  }
  constexpr double kOneColor = 1;  // variance, in bytes^2
  const double n = static_cast<double>(pairs.size());
  return s00 < kOneColor * n || s11 < kOneColor * n ? 0 : s01 / std::sqrt(s00 * s11);
}

/// One measure of the fit: its distance along the normal, and how that falls with a shift and turn.
struct Row {
  Vector6d slope;
  double off_m = 0;
};

/// Rows of the places whose number is (held_out) or is not a multiple of three.
std::vector<Row> rows_of(const Sides& sides, const Pose& a_from_b, double gate_m, bool held_out) {
  std::vector<Row> rows;
  const Eigen::Matrix3d turn = a_from_b.rotation.toRotationMatrix();
  look_all(sides, a_from_b, gate_m,
           [&](const Side& side, std::size_t i, const Vector3d& at_m, const Vector3d& normal,
               const Seen& seen) {
             if (seen.sight != Sight::kAgrees || (i % 3 == 0) != held_out) return;
             // In a's axes; the turn is about b's origin.
             const Vector3d n = side.of_b ? normal : side.places[i].normal;
             const Vector3d lever =
                 side.of_b ? Vector3d(at_m - a_from_b.translation_m) : Vector3d(turn * at_m);
             Row row;
             row.slope << n, lever.cross(n);
             if (!side.of_b) row.slope = -row.slope;
             row.off_m = seen.off_m;
             rows.push_back(row);
           });
  return rows;
}

double median_off_m(const std::vector<Row>& rows) {
  std::vector<double> off_m;
  for (const Row& row : rows) off_m.push_back(std::abs(row.off_m));
  return upper_median_in_place(std::span(off_m));
}

struct Normals {
  Matrix6d squares = Matrix6d::Zero();
  Vector6d right = Vector6d::Zero();
  double scale_m = 0;
};

/// With Cauchy's weights for 1.5 times the robust sigma.
Normals normals_of(const std::vector<Row>& rows) {
  Normals normals;
  normals.scale_m = std::max(5e-4, 1.4826 * median_off_m(rows));
  for (const Row& row : rows) {
    const double r = row.off_m / (1.5 * normals.scale_m), weight = 1 / (1 + r * r);
    normals.squares += weight * row.slope * row.slope.transpose();
    normals.right -= weight * row.off_m * row.slope;
  }
  return normals;
}

Pose stepped(const Pose& a_from_b, const Vector6d& step) {
  const Vector3d turn = step.tail<3>();
  const double angle = turn.norm();
  Pose out = a_from_b;
  if (angle > 1e-12)
    out.rotation =
        (Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle)) * out.rotation).normalized();
  out.translation_m += step.head<3>();
  return out;
}

Pose refined(const Sides& sides, Pose a_from_b, std::initializer_list<double> gates_m) {
  constexpr int kSteps = 8;
  constexpr double kWeakPrior = 1e-6;  // keeps an open direction where it is
  for (const double gate_m : gates_m)
    for (int i = 0; i < kSteps; ++i) {
      const std::vector<Row> rows = rows_of(sides, a_from_b, gate_m, false);
      if (rows.size() < 12) return a_from_b;
      Normals n = normals_of(rows);
      n.squares += kWeakPrior * static_cast<double>(rows.size()) * Matrix6d::Identity();
      const Vector6d step = n.squares.ldlt().solve(n.right);
      if (!step.allFinite() || step.norm() > 1) return a_from_b;
      a_from_b = stepped(a_from_b, step);
      if (step.norm() < 1e-6) break;
    }
  return a_from_b;
}

/// Sorted by falling `value`, ties in their order. By index: std::stable_sort's own buffer does not
/// keep the alignment of a pose.
template <typename Value>
void sort_falling(std::vector<Answer>& answers, std::size_t first_ones, const Value& value) {
  std::vector<std::size_t> order(first_ones);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t p, std::size_t q) {
    return value(answers[p]) > value(answers[q]);
  });
  std::vector<Answer> sorted;
  sorted.reserve(first_ones);
  for (const std::size_t i : order) sorted.push_back(answers[i]);
  std::copy(sorted.begin(), sorted.end(), answers.begin());
}

/// The best first, none nearly the same as one before it.
void keep_apart(std::vector<Answer>& answers, std::size_t most) {
  sort_falling(answers, answers.size(), [](const Answer& p) { return p.evidence.of_all(); });
  std::vector<Answer> kept;
  for (const Answer& answer : answers) {
    if (kept.size() == most) break;
    if (std::none_of(kept.begin(), kept.end(),
                     [&](const Answer& k) { return same(k.a_from_b, answer.a_from_b); }))
      kept.push_back(answer);
  }
  answers = std::move(kept);
}

std::vector<Answer> coarse_answers(const Panorama& a, const Panorama& b,
                                   const RegistrationOptions& options, Crew& crew) {
  const Sides sides = sides_of(a, b, kCoarseStep_rad);
  std::vector<Pose> poses = poses_from_planes(find_planes(a), find_planes(b));
  if (const auto& near = options.near_a_from_b) {
    std::erase_if(poses, [&](const Pose& p) { return !is_near(p, *near); });
    poses.push_back(refined(sides, *near, {0.5, 0.25, 0.12}));
  }
  std::vector<Answer> answers(poses.size());
  crew.rows(static_cast<int>(poses.size()), 64, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const auto k = static_cast<std::size_t>(i);
      answers[k] = {poses[k], evidence_of(sides, poses[k], kCoarseGate_m)};
    }
  });
  keep_apart(answers, kMostAnswers);
  return answers;
}

void refine(const Sides& sides, std::initializer_list<double> gates_m, std::vector<Answer>& answers,
            Crew& crew) {
  crew.rows(static_cast<int>(answers.size()), 1, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      Answer& answer = answers[static_cast<std::size_t>(i)];
      answer.a_from_b = refined(sides, answer.a_from_b, gates_m);
      answer.evidence = evidence_of(sides, answer.a_from_b, kFineGate_m);
      answer.color = color_agreement(sides, answer.a_from_b);
    }
  });
  keep_apart(answers, kMostAnswers);
}

double independent(int places) { return places * std::pow(kFineStep_rad / kPatch_rad, 2); }

/// By how many sigma the colours of one answer fit better (Fisher's z).
double color_sigmas(const Answer& p, const Answer& q) {
  const auto z = [](double r) { return std::atanh(std::clamp(r, -0.999, 0.999)); };
  const double n = independent(std::min(p.evidence.agree, q.evidence.agree));
  return n <= 4 ? 0 : (z(p.color) - z(q.color)) / std::sqrt(2 / (n - 3));
}

/// Among answers that the surfaces do not tell apart, the one whose colours fit best comes first.
void order_by_color(std::vector<Answer>& answers) {
  const double enough = kNearlyAsGood * answers.front().evidence.of_all();
  const auto end = std::find_if(answers.begin(), answers.end(),
                                [&](const Answer& p) { return p.evidence.of_all() < enough; });
  sort_falling(answers, static_cast<std::size_t>(end - answers.begin()),
               [](const Answer& p) { return p.color; });
}

Error refusal(const std::string& why, const std::string& what_to_do) {
  return {ErrorCode::kData, "the rooms cannot be joined: " + why + ": " + what_to_do};
}

Result<void> check_evidence(const Evidence& e) {
  if (e.overlap() < kLeastOverlap)
    return refusal(
        fmt::format("only {:.0f} % of their surfaces are seen from both places", 100 * e.overlap()),
        "scan from places that see more of the same surfaces");
  if (e.agreeing() < kLeastAgreeing)
    return refusal(fmt::format("at best {:.0f} % of what both see agrees, 70 % are needed",
                               100 * e.agreeing()),
                   "give two scans of the same room, with little moved between them");
  // Furniture hides some of a room; what hides most of it is another room's wall.
  if (e.agree < kLeastOfKnown * (e.agree + e.against + e.hidden))
    return refusal(fmt::format("{:.0f} % of the places lie behind surfaces of the other room",
                               100.0 * e.hidden / (e.agree + e.against + e.hidden)),
                   "give two scans of the same room");
  return {};
}

Result<double> runner_up(const std::vector<Answer>& answers) {
  double most = 0;
  const Answer& best = answers.front();
  for (std::size_t i = 1; i < answers.size(); ++i) {
    const double share = answers[i].evidence.of_all() / best.evidence.of_all();
    most = std::max(most, share);
    if (share < kNearlyAsGood || color_sigmas(best, answers[i]) > kColorSigmas) continue;
    const auto text = [](const Pose& p) {
      const Vector3d ahead = p.rotation * Vector3d::UnitY();
      return fmt::format("\"{:.2f} {:.2f} {:.2f} {:.0f}\"", p.translation_m.x(),
                         p.translation_m.y(), p.translation_m.z(),
                         std::atan2(-ahead.x(), ahead.y()) / kDeg);
    };
    return refusal(fmt::format("{} and {} (x y z in m, yaw in degrees) fit nearly as well",
                               text(best.a_from_b), text(answers[i].a_from_b)),
                   "choose one by --near, or scan with things in the room that differ");
  }
  return most;
}

/// The covariance, and whether the surfaces hold every direction.
Result<void> judge(const Sides& sides, Registration& out) {
  const std::vector<Row> rows = rows_of(sides, out.a_from_b, kFineGate_m, false);
  const Normals n = normals_of(rows);
  const double count = static_cast<double>(rows.size());
  const Matrix6d inverse =
      (n.squares + 1e-9 * count * Matrix6d::Identity()).ldlt().solve(Matrix6d::Identity());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> shift(inverse.topLeftCorner<3, 3>());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> turn(inverse.bottomRightCorner<3, 3>());
  const Vector3d open = shift.eigenvectors().col(2);
  if (!(shift.eigenvalues()[2] * kLeastHold * count < 1))
    return refusal(fmt::format("no surface that both see holds them along ({:.2f}, {:.2f}, {:.2f})",
                               open.x(), open.y(), open.z()),
                   "scan from places that both see an end wall or furniture");
  const double variance =
      n.scale_m * n.scale_m * count / std::max(1.0, independent(static_cast<int>(rows.size())));
  out.covariance = variance * inverse;
  out.sigma_m = std::sqrt(variance * shift.eigenvalues()[2]);
  out.sigma_rad = std::sqrt(variance * turn.eigenvalues()[2]);
  out.held_out_m = median_off_m(rows_of(sides, out.a_from_b, kFineGate_m, true));
  return {};
}

/// Where places of one side lie in what the other sees as free space.
void find_moved(const Side& side, const Pose& a_from_b, std::vector<MovedArea>& moved) {
  constexpr double kOff_m = 0.05, kLeastMoved_sr = 9 * kDeg * kDeg;
  constexpr Size kGrid{180, 90};
  const Pose pose = to_other(side, a_from_b);
  Image<std::uint8_t> against(kGrid);
  for (const RoomPlace& place : side.places) {
    const Vector3d at_m = pose * place.at_m;
    if (look(*side.panorama, at_m, pose.rotation * place.normal, place.sigma_m, kOff_m).sight !=
        Sight::kAgainst)
      continue;
    const Vector3d ray = place.at_m.normalized();
    const double azimuth = std::atan2(-ray.x(), ray.y()), elevation = std::asin(ray.z());
    const int x = static_cast<int>((kPi - azimuth) / (2 * kPi) * kGrid.width) % kGrid.width;
    const int y = std::clamp(static_cast<int>((kPi / 2 - elevation) / kPi * kGrid.height), 0,
                             kGrid.height - 1);
    against.row(y)[x] = 1;
  }
  const auto areas = areas_of(kGrid, Directions(kGrid), Vector3d::Zero(),
                              [&](int x, int y) { return against.row(y)[x] != 0; });
  for (const SphereArea& area : areas)
    if (area.solid_angle_sr >= kLeastMoved_sr)
      moved.push_back({side.of_b, std::atan2(-area.direction.x(), area.direction.y()) / kDeg,
                       std::asin(area.direction.z()) / kDeg, area.solid_angle_sr / kDeg / kDeg});
}

}  // namespace

Result<Registration> register_rooms(const Panorama& a, const Panorama& b,
                                    const RegistrationOptions& options, Crew& crew) {
  std::vector<Answer> answers = coarse_answers(a, b, options, crew);
  refine(sides_of(a, b, kMiddleStep_rad), {0.1, 0.05, kFineGate_m}, answers, crew);
  if (options.near_a_from_b)
    std::erase_if(answers,
                  [&](const Answer& p) { return !is_near(p.a_from_b, *options.near_a_from_b); });
  if (!answers.empty()) {
    const double enough = kWorthRefining * answers.front().evidence.of_all();
    std::erase_if(answers, [&](const Answer& p) { return p.evidence.of_all() < enough; });
  }
  const Sides sides = sides_of(a, b, kFineStep_rad);
  refine(sides, {kFineGate_m}, answers, crew);
  if (answers.empty())
    return refusal(options.near_a_from_b ? "nothing near the given place fits"
                                         : "they have no three walls in common that are not "
                                           "parallel",
                   options.near_a_from_b ? "give another --near, or none"
                                         : "scan from places that both see a corner of the room");
  order_by_color(answers);
  const Answer& best = answers.front();
  MIXRIG_TRY(check_evidence(best.evidence));
  Registration out;
  out.a_from_b = best.a_from_b;
  MIXRIG_TRY(judge(sides, out));
  MIXRIG_ASSIGN(out.runner_up, runner_up(answers));
  out.places = best.evidence.agree + best.evidence.against;
  out.overlap_share = best.evidence.overlap();
  out.agreeing_share = best.evidence.agreeing();
  out.color_agreement = best.color;
  for (const Side& side : sides) find_moved(side, out.a_from_b, out.moved);
  std::stable_sort(out.moved.begin(), out.moved.end(), [](const MovedArea& p, const MovedArea& q) {
    return p.square_deg > q.square_deg;
  });
  return out;
}

}  // namespace mixrig::model

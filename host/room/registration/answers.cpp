// SPDX-License-Identifier: Apache-2.0
#include "host/room/registration/answers.h"

#include <algorithm>
#include <numeric>

#include "host/room/registration/fit.h"
#include "host/room/registration/plane_guesses.h"

namespace mixrig::model {
namespace {

using Eigen::Vector3d;
using geometry::Pose;

constexpr double kCoarseStep_rad = 9 * kDeg, kMiddleStep_rad = 5 * kDeg;
constexpr double kCoarseGate_m = 0.06;
constexpr double kApart_m = 0.1, kApart_rad = 3 * kDeg;
constexpr std::size_t kMostAnswers = 12, kMostAgreeing = 4;  ///< that are refined
constexpr double kWorthRefining = 0.75;                      ///< of the evidence of the best
constexpr double kWorthAgreeing = 0.1;  ///< agreeing share below that of the best answer
constexpr double kNear_m = 0.75, kNear_rad = 25 * kDeg;
constexpr double kAlongStep_rad = 13 * kDeg, kSlide_m = 0.1;

bool within(const Pose& p, const Pose& q, double most_m, double most_rad) {
  return (p.translation_m - q.translation_m).norm() < most_m &&
         p.rotation.angularDistance(q.rotation) < most_rad;
}

/// Sorts by index, since std::stable_sort's own buffer does not keep the alignment of a pose.
template <typename Value>
void sort_answers(std::vector<Answer>& answers, std::size_t first_ones, const Value& value) {
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

/// Moves up to `most` answers that are apart from those in `kept` there, in their order.
void take_apart(const std::vector<Answer>& answers, std::size_t most, std::vector<Answer>& kept) {
  for (const Answer& answer : answers) {
    if (most == 0) break;
    if (std::any_of(kept.begin(), kept.end(), [&](const Answer& k) {
          return within(k.a_from_b, answer.a_from_b, kApart_m, kApart_rad);
        }))
      continue;
    kept.push_back(answer);
    --most;
  }
}

/// Keeps the answers with the most evidence, and of the plausible ones those that agree best.
void keep_apart(std::vector<Answer>& answers) {
  std::vector<Answer> kept;
  sort_answers(answers, answers.size(), [](const Answer& p) { return p.evidence.of_all(); });
  take_apart(answers, kMostAnswers, kept);
  std::erase_if(answers, [](const Answer& p) { return !is_plausible(p.evidence); });
  sort_answers(answers, answers.size(), [](const Answer& p) { return p.evidence.agreeing(); });
  take_apart(answers, kMostAgreeing, kept);
  answers = std::move(kept);
}

std::vector<Answer> judged(const Sides& sides, const std::vector<Pose>& poses, Crew& crew) {
  std::vector<Answer> answers(poses.size());
  crew.rows(static_cast<int>(poses.size()), 64, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const auto k = static_cast<std::size_t>(i);
      answers[k] = {poses[k], evidence_of(sides, poses[k], kCoarseGate_m)};
    }
  });
  keep_apart(answers);
  return answers;
}

void refine(const Sides& sides, std::initializer_list<double> gates_m, std::vector<Answer>& answers,
            Crew& crew) {
  crew.rows(static_cast<int>(answers.size()), 1, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      Answer& answer = answers[static_cast<std::size_t>(i)];
      answer.a_from_b = refined_pose(sides, answer.a_from_b, gates_m);
      answer.evidence = evidence_of(sides, answer.a_from_b, kSurfaceGate_m);
      answer.color = color_agreement(sides, answer.a_from_b);
    }
  });
  keep_apart(answers);
}

void erase_far(const RegistrationOptions& options, std::vector<Answer>& answers) {
  if (const auto& near = options.near_a_from_b)
    std::erase_if(answers,
                  [&](const Answer& p) { return !within(p.a_from_b, *near, kNear_m, kNear_rad); });
}

}  // namespace

std::vector<Answer> find_answers(const Panorama& a, const Panorama& b,
                                 const std::vector<RoomPlane>& of_a,
                                 const std::vector<RoomPlane>& of_b, const Sides& fine_sides,
                                 const RegistrationOptions& options, Crew& crew) {
  const Sides coarse = sides_of(a, b, kCoarseStep_rad), middle = sides_of(a, b, kMiddleStep_rad);
  std::vector<Pose> poses = poses_from_planes(of_a, of_b);
  std::vector<Pose> along_walls = poses_along_walls(of_a, of_b, kSlide_m);
  if (const auto& near = options.near_a_from_b) {
    const auto is_far = [&](const Pose& p) { return !within(p, *near, kNear_m, kNear_rad); };
    std::erase_if(poses, is_far);
    std::erase_if(along_walls, is_far);
    poses.push_back(refined_pose(coarse, *near, {0.5, 0.25, 0.12}));
  }
  std::vector<Answer> answers = judged(coarse, poses, crew);
  refine(middle, {0.1, 0.05, kSurfaceGate_m}, answers, crew);
  std::vector<Answer> along = judged(sides_of(a, b, kAlongStep_rad), along_walls, crew);
  refine(middle, {0.1, 0.05, kSurfaceGate_m}, along, crew);
  answers.insert(answers.end(), along.begin(), along.end());
  keep_apart(answers);
  erase_far(options, answers);
  if (answers.empty()) return answers;
  const Evidence best = answers.front().evidence;
  std::erase_if(answers, [&](const Answer& p) {
    return p.evidence.of_all() < kWorthRefining * best.of_all() &&
           !(is_plausible(p.evidence) && p.evidence.agreeing() > best.agreeing() - kWorthAgreeing);
  });
  refine(fine_sides, {kSurfaceGate_m}, answers, crew);
  return answers;
}

void sort_by_color(std::vector<Answer>& answers, std::size_t first_ones) {
  sort_answers(answers, first_ones, [](const Answer& p) { return p.color; });
}

}  // namespace mixrig::model

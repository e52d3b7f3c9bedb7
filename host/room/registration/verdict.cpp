// SPDX-License-Identifier: Apache-2.0
#include "host/room/registration/verdict.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "hal/base/angles.h"

namespace mixrig::model {
namespace {

using Eigen::Vector3d;

constexpr double kNearlyAsGood = 0.9;  ///< a tenth of a room may have changed
constexpr double kAgreesNearlyAsWell = 0.05;
constexpr double kAgreesAsWell = 0.01;  ///< largest difference of shares that agree equally well
constexpr double kColorSigmas = 3;
constexpr double kLeastColor = 0.8;            ///< that of a room turned half around is 0.7
constexpr double kColorPatch_rad = 10 * kDeg;  ///< side of a patch that counts as one colour
/// Least share of the places whose normals hold a direction of the translation.
constexpr double kLeastHold = 0.01;
constexpr double kLeastCheck = 0.008;  ///< that share when one wall is left out
constexpr double kUpright = 0.8;       ///< normals nearer to the z axis are those of floors

/// By how many sigma the colours of one answer fit better (Fisher's z).
double color_sigmas(const Answer& p, const Answer& q) {
  const auto z = [](double r) { return std::atanh(std::clamp(r, -0.999, 0.999)); };
  const double n =
      std::min(p.evidence.agree, q.evidence.agree) * std::pow(kFineStep_rad / kColorPatch_rad, 2);
  return n <= 4 ? 0 : (z(p.color) - z(q.color)) / std::sqrt(2 / (n - 3));
}

std::string near_text(const geometry::Pose& p) {
  const Vector3d ahead = p.rotation * Vector3d::UnitY();
  return fmt::format("\"{:.2f} {:.2f} {:.2f} {:.0f}\"", p.translation_m.x(), p.translation_m.y(),
                     p.translation_m.z(), std::atan2(-ahead.x(), ahead.y()) / kDeg);
}

/// Whether another answer explains what both rooms see as well as the best: also one of smaller
/// overlap that fewer places contradict.
bool is_rival(const Answer& other, const Answer& best) {
  const double worse = best.evidence.agreeing() - other.evidence.agreeing();
  if (other.evidence.of_all() >= kNearlyAsGood * best.evidence.of_all())
    return worse < kAgreesNearlyAsWell;
  return is_plausible(other.evidence) && worse < kAgreesAsWell;
}

}  // namespace

Error refusal(const std::string& why, const std::string& what_to_do) {
  return {ErrorCode::kData, "the rooms cannot be joined: " + why + ": " + what_to_do};
}

void order_by_color(std::vector<Answer>& answers) {
  const Answer best = answers.front();
  const auto end = std::find_if_not(answers.begin(), answers.end(), [&](const Answer& p) {
    return p.evidence.of_all() >= kNearlyAsGood * best.evidence.of_all();
  });
  sort_by_color(answers, static_cast<std::size_t>(end - answers.begin()));
}

Result<void> check_evidence(const Answer& best, bool is_near) {
  const Evidence& e = best.evidence;
  if (e.overlap() < kLeastOverlap)
    return refusal(fmt::format("only {:.0f} % of their surfaces are seen from both places, {:.0f} "
                               "% are needed",
                               100 * e.overlap(), 100 * kLeastOverlap),
                   "scan from places that see more of the same surfaces");
  if (e.agreeing() < kLeastAgreeing)
    return refusal(fmt::format("at best {:.0f} % of what both see agrees, {:.0f} % are needed",
                               100 * e.agreeing(), 100 * kLeastAgreeing),
                   "give two scans of the same room, with little moved between them");
  // Furniture hides some of a room; what hides most of it is another room's wall.
  if (e.of_known() < kLeastOfKnown)
    return refusal(fmt::format("{:.0f} % of the places lie behind surfaces of the other room",
                               100.0 * e.hidden / (e.agree + e.against + e.hidden)),
                   "give two scans of the same room");
  if (!is_near && best.color != 0 && best.color < kLeastColor)
    return refusal(fmt::format("{:.0f} % of what both see agrees, but the colours do not "
                               "(correlation {:.2f}, {:.1f} is needed)",
                               100 * e.agreeing(), best.color, kLeastColor),
                   "say by --near where the second stood, or give two scans of the same room in "
                   "the same light");
  return {};
}

Result<double> check_rivals(const std::vector<Answer>& answers) {
  double most = 0;
  const Answer& best = answers.front();
  for (std::size_t i = 1; i < answers.size(); ++i) {
    most = std::max(most, answers[i].evidence.of_all() / best.evidence.of_all());
    if (!is_rival(answers[i], best) || color_sigmas(best, answers[i]) > kColorSigmas) continue;
    return refusal(fmt::format("{} and {} (x y z in m, yaw in degrees) fit nearly as well",
                               near_text(best.a_from_b), near_text(answers[i].a_from_b)),
                   "choose one by --near, or scan with things in the room that differ");
  }
  return most;
}

Result<double> check_hold(const std::vector<FitRow>& rows, const std::vector<int>& units,
                          bool is_near) {
  const auto text = [](const Vector3d& v) {
    return fmt::format("({:.2f}, {:.2f}, {:.2f})", v.x(), v.y(), v.z());
  };
  const Hold all = hold_of(rows, units, -1);
  if (!(all.share > kLeastHold))
    return refusal("no surface that both see holds them along " + text(all.open),
                   "scan from places that both see an end wall or furniture");
  double least = all.share;
  const int last = *std::max_element(units.begin(), units.end());
  for (int unit = 0; unit <= last; ++unit) {
    const auto of_unit = std::find(units.begin(), units.end(), unit) - units.begin();
    if (std::abs(rows[static_cast<std::size_t>(of_unit)].normal.z()) > kUpright) continue;
    const Hold without = hold_of(rows, units, unit);
    least = std::min(least, without.share);
    if (!is_near && !(without.share > kLeastCheck))
      return refusal(
          fmt::format("along {} one wall alone holds them ({:.1f} % of what both see holds them "
                      "without it, {:.1f} % are needed), and the other end of a hall would fit "
                      "too",
                      text(without.open), 100 * without.share, 100 * kLeastCheck),
          "say by --near where the second stood, or scan from places that both see furniture");
  }
  return least;
}

}  // namespace mixrig::model

// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include <gtest/gtest.h>

#include "tests/stability/random_geometry.h"
#include "tests/stability/suite.h"

namespace mixrig::estimation_bench {
namespace {

void run(void (*add)(std::vector<Case>&)) {
  std::vector<Case> cases;
  add(cases);
  ASSERT_FALSE(cases.empty());
  Report report;
  for (const Case& c : cases) {
    report.rows.push_back(measure(c, kShortEffort));
    for (const std::string& fault : faults_of(report.rows.back())) ADD_FAILURE() << fault;
  }
  if (::testing::Test::HasFailure()) std::fputs(to_table(report).c_str(), stdout);
}

TEST(Stability, RigidAndSimilarityFit) { run(add_rigid_fit_cases); }
TEST(Stability, Multilateration) { run(add_multilateration_cases); }
TEST(Stability, Triangulation) { run(add_triangulation_cases); }
TEST(Stability, Pnp) { run(add_pnp_cases); }
TEST(Stability, PlaneFit) { run(add_plane_fit_cases); }
TEST(Stability, HandEye) { run(add_hand_eye_cases); }
TEST(Stability, PanTiltChain) { run(add_pan_tilt_cases); }
TEST(Stability, Constellation) { run(add_constellation_cases); }
TEST(Stability, Lamps) { run(add_lamp_cases); }
TEST(Stability, Shading) { run(add_shading_cases); }
TEST(Stability, Exposures) { run(add_exposure_cases); }
#ifdef MIXRIG_EXTRA_MAP
TEST(Stability, PlaceOfAMap) { run(add_map_place_cases); }
#endif
#ifdef MIXRIG_EXTRA_PEOPLE
TEST(Stability, People) { run(add_people_cases); }
#endif

TEST(Stability, BlobCentresAreAsGoodAsTheyClaimFromRadiusTwo) {
  std::vector<std::string> faults;
  for (const BlobBias& blob : measure_blob_bias(100)) add_faults(blob, faults);
  for (const std::string& fault : faults) ADD_FAILURE() << fault;
}

/// A case of a made-up estimator of one number, whose error and claimed sigma are given.
Case made_up(Expect expect, double error_sigmas, double claimed_sigma, bool refuses = false) {
  return {"made_up", "a case", expect, [=](std::uint64_t seed, Residuals& residuals) {
            Trial trial;
            if (refuses) {
              trial.verdict = estimation::Verdict::degenerate("made up");
              return trial;
            }
            trial.verdict = estimation::Verdict::ok();
            RandomGeometry random(seed);
            const double noise = random.normal();
            trial.error = Eigen::VectorXd::Constant(1, error_sigmas * noise);
            trial.covariance = Eigen::MatrixXd::Constant(1, 1, claimed_sigma * claimed_sigma);
            residuals = [noise](const Reals& x) { return Reals{x[0] - Real(noise)}; };
            return trial;
          }};
}

std::size_t faults(const Case& c) { return faults_of(measure(c, {200, 1, true})).size(); }

TEST(Judge, MarksWhatFallsShort) {
  EXPECT_EQ(faults(made_up(Expect::kAnswer, 1, 1)), 0u);
  EXPECT_EQ(faults(made_up(Expect::kAnswer, 1, 1, true)), 1u) << "refused";
  EXPECT_EQ(faults(made_up(Expect::kAnswer, 1, 2)), 1u) << "too modest";
  EXPECT_EQ(faults(made_up(Expect::kAnswer, 1, 0.5)), 1u) << "overconfident";
  EXPECT_GE(faults(made_up(Expect::kAnswer, 1.5, 1.5)), 2u) << "not efficient, off the minimum";
  EXPECT_EQ(faults(made_up(Expect::kCareful, 1, 1, true)), 0u);
  EXPECT_EQ(faults(made_up(Expect::kCareful, 1, 0.5)), 1u);
  EXPECT_EQ(faults(made_up(Expect::kRefusal, 1, 1, true)), 0u);
  EXPECT_EQ(faults(made_up(Expect::kRefusal, 1, 1)), 1u);
}

TEST(Judge, KnowsWhatChancePutsOutside) {
  EXPECT_EQ(most_outside_95(1), 1);
  EXPECT_EQ(most_outside_95(20), 3);
  EXPECT_EQ(most_outside_95(100), 10);
}

}  // namespace
}  // namespace mixrig::estimation_bench

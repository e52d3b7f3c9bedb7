// SPDX-License-Identifier: Apache-2.0
#include "tests/stability/harness.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

namespace mixrig::stability {
namespace {

/// One line of the table.
struct Row {
  std::string estimator, name;
  int ok = 0, weak = 0, refused = 0;
  double over_bound = NAN;     // root mean square error over the Cramer-Rao bound
  double nees = NAN;           // mean, per degree of freedom
  double low = 0, high = 0;    // 95 % interval of that mean
  double off_reference = NAN;  // greatest distance to the 50-digit minimum, sigmas
  double micros = 0;           // median
};

double quadratic(const Eigen::VectorXd& e, const Eigen::MatrixXd& covariance) {
  // Scaled to unit diagonal: covariances mix radians and (far from the origin) kilometres.
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd c = scale.asDiagonal() * covariance * scale.asDiagonal();
  const Eigen::VectorXd s = scale.asDiagonal() * e;
  return s.dot(c.ldlt().solve(s));
}

/// The table and its plot, written when all tests are done.
class Table : public ::testing::Environment {
 public:
  void add(const Row& row) { rows_.push_back(row); }
  void TearDown() override {
    if (rows_.empty()) return;
    const std::string text = table();
    std::fputs(text.c_str(), stdout);
    const char* folder = std::getenv("MIXRIG_STABILITY_OUT");
    if (folder == nullptr) return;
    std::ofstream(std::string(folder) + "/stability.txt") << text;
    std::ofstream(std::string(folder) + "/stability.svg") << plot();
  }

 private:
  std::string table() const {
    std::string text =
        "estimator         case                             verdicts o/w/d  err/CRB   NEES/dof "
        "(95 % interval)   off 50 digits  time us\n";
    char line[256];
    for (const Row& r : rows_) {
      std::snprintf(line, sizeof line, "%-17s %-32s %4d/%3d/%3d    ", r.estimator.c_str(),
                    r.name.c_str(), r.ok, r.weak, r.refused);
      text += line;
      if (std::isnan(r.nees))
        text += "      -        -                            -     ";
      else if (std::isnan(r.over_bound))
        std::snprintf(line, sizeof line, "    -     %5.2f (%4.2f..%4.2f)                -     ",
                      r.nees, r.low, r.high),
            text += line;
      else
        std::snprintf(line, sizeof line, "%7.3f   %5.2f (%4.2f..%4.2f)         %9.1e ",
                      r.over_bound, r.nees, r.low, r.high, r.off_reference),
            text += line;
      std::snprintf(line, sizeof line, "%9.1f\n", r.micros);
      text += line;
    }
    return text;
  }

  /// Error over the bound and NEES of every case that has them, side by side.
  std::string plot() const {
    constexpr int kRow = 16, kLeft = 330, kUnit = 220;
    int y = 40;
    std::string body;
    char line[400];
    for (const Row& r : rows_) {
      if (std::isnan(r.nees)) continue;
      const double bound = std::min(r.over_bound, 2.0), nees = std::min(r.nees, 2.0);
      std::snprintf(line, sizeof line, "<text x='%d' y='%d' text-anchor='end'>%s: %s</text>\n",
                    kLeft - 8, y + 4, r.estimator.c_str(), r.name.c_str());
      body += line;
      std::snprintf(line, sizeof line,
                    "<line x1='%.1f' y1='%d' x2='%.1f' y2='%d' stroke='#9ab' stroke-width='5'/>\n",
                    kLeft + kUnit * std::min(r.low, 2.0), y, kLeft + kUnit * std::min(r.high, 2.0),
                    y);
      body += line;
      std::snprintf(line, sizeof line, "<circle cx='%.1f' cy='%d' r='3.5' fill='#c33'/>\n",
                    kLeft + kUnit * nees, y);
      body += line;
      if (!std::isnan(bound)) {
        std::snprintf(line, sizeof line, "<path d='M%.1f %d l4 4 l-4 4 l-4 -4z' fill='#236'/>\n",
                      kLeft + kUnit * bound, y - 4);
        body += line;
      }
      y += kRow;
    }
    std::snprintf(line, sizeof line,
                  "<svg xmlns='http://www.w3.org/2000/svg' width='%d' height='%d' "
                  "font-family='sans-serif' font-size='11'>\n<rect width='100%%' height='100%%' "
                  "fill='white'/>\n",
                  kLeft + 2 * kUnit + 20, y + 10);
    std::string head = line;
    std::snprintf(
        line, sizeof line,
        "<text x='%d' y='18'>blue: error / Cramer-Rao bound; red: NEES / dof, bar: its 95 "
        "%% interval; right edge: 2 or more</text>\n<line x1='%d' y1='28' x2='%d' y2='%d' "
        "stroke='#999'/>\n",
        20, kLeft + kUnit, kLeft + kUnit, y);
    return head + line + body + "</svg>\n";
  }

  std::vector<Row> rows_;
};

Table* const table = static_cast<Table*>(::testing::AddGlobalTestEnvironment(new Table));

/// Runs all trials; bound and reference come from the residuals that the trial leaves.
Row measure(const Case& c) {
  Row row{c.estimator, c.name};
  double over_bound = 0, nees = 0;
  int answers = 0, compared = 0, referenced = 0;
  std::vector<double> micros;
  Eigen::Index dof = 0;
  for (int i = 0; i < c.trials; ++i) {
    Residuals residuals;
    const Trial t = c.trial(1000 + i, residuals);
    micros.push_back(t.micros);
    using estimation::Standing;
    if (t.verdict.standing == Standing::kDegenerate) {
      EXPECT_FALSE(t.verdict.reason.empty());
      ++row.refused;
      continue;
    }
    ++(t.verdict.standing == Standing::kOk ? row.ok : row.weak);
    ++answers;
    dof = t.error.size();
    nees += quadratic(t.error, t.covariance);
    if (!residuals) continue;
    const Eigen::MatrixXd bound = cramer_rao(residuals, static_cast<int>(dof));
    over_bound += quadratic(t.error, bound);
    ++compared;
    constexpr int kReferenced = 3;
    if (referenced++ >= kReferenced) continue;
    const double off =
        std::sqrt(quadratic(t.error - minimum(residuals, static_cast<int>(dof)), bound));
    row.off_reference = std::isnan(row.off_reference) ? off : std::max(row.off_reference, off);
  }
  std::nth_element(micros.begin(), micros.begin() + micros.size() / 2, micros.end());
  row.micros = micros[micros.size() / 2];
  if (answers == 0) return row;
  const double n = static_cast<double>(answers) * static_cast<double>(dof);
  row.nees = nees / n;
  if (compared > 0)
    row.over_bound =
        std::sqrt(over_bound / (static_cast<double>(compared) * static_cast<double>(dof)));
  row.low = estimation::chi2_limit(static_cast<int>(n), -1.96) / n;
  row.high = estimation::chi2_limit(static_cast<int>(n), 1.96) / n;
  return row;
}

}  // namespace

void check(const Case& c) {
  SCOPED_TRACE(c.estimator + ": " + c.name);
  const Row row = measure(c);
  table->add(row);
  if (c.expect == Expect::kRefusal) {
    EXPECT_EQ(row.refused, c.trials) << "a confident answer to what has none";
    return;
  }
  if (c.expect == Expect::kCareful) {
    EXPECT_FALSE(row.nees >= 2 * row.high) << "overconfident";
    return;
  }
  EXPECT_EQ(row.refused, 0) << "refused what can be answered";
  EXPECT_LE(row.over_bound, 1.1) << "not efficient";
  EXPECT_GE(row.nees, row.low) << "too modest";
  EXPECT_LE(row.nees, row.high) << "overconfident";
  EXPECT_LT(row.off_reference, 1e-3) << "far from the minimum in 50 digits, in sigmas";
}

}  // namespace mixrig::stability

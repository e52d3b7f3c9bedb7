// SPDX-License-Identifier: Apache-2.0
// The cheapest assignment of rows to columns.
#include "extras/people/plan/assignment.h"

#include <algorithm>
#include <cstddef>

namespace mixrig::plan {
namespace {

/// Adds row `first` to the assignment by the shortest path to a free column. Index 0 of columns is
/// where the path begins.
struct Augment {
  const Eigen::MatrixXd& cost;
  std::vector<double> of_row, of_column;  ///< dual prices
  std::vector<int> row_of;                ///< of each column, 0: free; rows count from 1

  void add(int first) {
    const std::size_t columns = row_of.size();
    std::vector<double> least(columns, std::numeric_limits<double>::infinity());
    std::vector<std::size_t> before(columns, 0);
    std::vector<bool> done(columns, false);
    row_of[0] = first;
    std::size_t at = 0;
    do {
      done[at] = true;
      const auto row = static_cast<std::size_t>(row_of[at]);
      double step = std::numeric_limits<double>::infinity();
      std::size_t next = 0;
      for (std::size_t c = 1; c < columns; ++c) {
        if (done[c]) continue;
        const double price =
            cost(static_cast<Eigen::Index>(row - 1), static_cast<Eigen::Index>(c - 1)) -
            of_row[row] - of_column[c];
        if (price < least[c]) least[c] = price, before[c] = at;
        if (least[c] < step) step = least[c], next = c;
      }
      for (std::size_t c = 0; c < columns; ++c)
        if (done[c])
          of_row[static_cast<std::size_t>(row_of[c])] += step, of_column[c] -= step;
        else
          least[c] -= step;
      at = next;
    } while (row_of[at] != 0);
    for (; at != 0; at = before[at]) row_of[at] = row_of[before[at]];
  }
};

}  // namespace

std::vector<int> assign(const Eigen::MatrixXd& cost) {
  const Eigen::Index rows = cost.rows(), columns = cost.cols();
  // A column of its own for each row, dearer than all pairs together, stands for none.
  double dear = 1;
  for (Eigen::Index r = 0; r < rows; ++r)
    for (Eigen::Index c = 0; c < columns; ++c)
      if (cost(r, c) < kForbidden) dear += cost(r, c);
  Eigen::MatrixXd all = Eigen::MatrixXd::Constant(rows, columns + rows, dear);
  all.leftCols(columns) = cost.array().min(4 * dear);
  Augment augment{all, std::vector<double>(static_cast<std::size_t>(rows) + 1),
                  std::vector<double>(static_cast<std::size_t>(columns + rows) + 1),
                  std::vector<int>(static_cast<std::size_t>(columns + rows) + 1)};
  for (int row = 1; row <= rows; ++row) augment.add(row);
  std::vector<int> column_of(static_cast<std::size_t>(rows), -1);
  for (Eigen::Index c = 0; c < columns; ++c)
    if (const int row = augment.row_of[static_cast<std::size_t>(c) + 1];
        row > 0 && cost(row - 1, c) < kForbidden)
      column_of[static_cast<std::size_t>(row) - 1] = static_cast<int>(c);
  return column_of;
}

}  // namespace mixrig::plan

// SPDX-License-Identifier: Apache-2.0
// A solver whose sparse matrices Ceres would give to SuiteSparse.
#include <ceres/ceres.h>
ceres::Solver::Options options;

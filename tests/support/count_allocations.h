// SPDX-License-Identifier: Apache-2.0
// Counts calls of operator new in this program; add count_allocations.cpp to the test's sources.
#pragma once

#include <atomic>

namespace mixrig::test {

extern std::atomic<long> allocations;
/// Allocations of the calling thread alone.
extern thread_local long own_allocations;

}  // namespace mixrig::test

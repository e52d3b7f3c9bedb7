// SPDX-License-Identifier: Apache-2.0
// Turns what a thread throws into an error, so that a run ends in good order.
#pragma once

#include <atomic>
#include <exception>
#include <new>
#include <string>
#include <string_view>
#include <thread>
#include <type_traits>
#include <utility>

#include "hal/base/result.h"

namespace mixrig {

/// Called with the name of each guarded work before it, in its thread. Null but in tests, whose
/// function throws what the work could throw.
inline std::atomic<void (*)(std::string_view name)> before_guarded = nullptr;

/// Calls work(), which returns nothing or a Result<void>. Returns its error, or what it threw as an
/// error of `name`. Errors: kIo.
template <typename Work>
Result<void> guarded(std::string_view name, Work&& work) {
  try {
    if (const auto before = before_guarded.load(std::memory_order_relaxed)) before(name);
    if constexpr (std::is_void_v<decltype(work())>) {
      work();
      return {};
    } else {
      return work();
    }
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::kIo, std::string(name) + ": no memory is left: stop other programs"};
  } catch (const std::exception& error) {
    return Error{ErrorCode::kIo, std::string(name) + " failed unexpectedly: " + error.what()};
  } catch (...) {
    return Error{ErrorCode::kIo, std::string(name) + " failed unexpectedly"};
  }
}

/// Starts a thread that calls work() once; `name` must outlive it. Its error, or what it threw, is
/// given to failed(const Error&) in that thread, which must not throw.
template <typename Work, typename Failed>
std::thread guarded_thread(std::string_view name, Work work, Failed failed) {
  return std::thread([name, work = std::move(work), failed = std::move(failed)]() mutable {
    const Result<void> done = guarded(name, work);
    if (!done) failed(done.error());
  });
}

}  // namespace mixrig

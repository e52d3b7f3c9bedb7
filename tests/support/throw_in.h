// SPDX-License-Identifier: Apache-2.0
// Lets a thread throw, as where no memory is left.
#pragma once

#include <algorithm>
#include <atomic>
#include <new>
#include <string>
#include <string_view>

#include "hal/base/guarded.h"
#include "hal/base/recent_log.h"

namespace mixrig::test {

/// While it lives, the first `times` guarded works of that name (hal/base/guarded.h) throw
/// std::bad_alloc. One at a time in a program. `name` must outlive it.
class ThrowIn {
 public:
  explicit ThrowIn(std::string_view name, int times = 1) {
    name_ = name, left_ = times;
    before_guarded = +[](std::string_view starts) {
      if (starts == name_ && left_.fetch_sub(1) > 0) throw std::bad_alloc();
    };
  }
  ~ThrowIn() { before_guarded = nullptr; }
  ThrowIn(const ThrowIn&) = delete;
  ThrowIn& operator=(const ThrowIn&) = delete;
  /// True once it has thrown as often as it shall.
  bool done() const { return left_ <= 0; }

 private:
  static inline std::string_view name_;
  static inline std::atomic<int> left_ = 0;
};

/// Whether one of the last lines of the log has these words.
inline bool logged(std::string_view words) {
  return std::ranges::any_of(recent_log_lines(), [&](const std::string& line) {
    return line.find(words) != std::string::npos;
  });
}

}  // namespace mixrig::test

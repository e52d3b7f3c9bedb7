// SPDX-License-Identifier: Apache-2.0
// Result<T>: a value or an Error, with the names of std::expected.
#pragma once

#include <cassert>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

namespace mixrig {

/// Kind of an error. The command maps kUsage and kFormat to exit status 2 (wrong arguments or a
/// wrong file), everything else to 1 (it failed while running).
enum class ErrorCode { kUsage, kFormat, kNotFound, kIo, kDevice, kTimeout, kData, kUnsupported };

/// One error: `context` is a complete line "what, why, where: what to do".
struct Error {
  ErrorCode code = ErrorCode::kIo;
  std::string context;
  int sys_errno = 0;  ///< errno of the failing call, 0 where none
};

/// The line that a user sees: context, then the text of sys_errno where there is one.
std::string to_line(const Error& error);

/// Error of a failing system call: `context` plus errno.
Error system_error(ErrorCode code, std::string context, int sys_errno);

/// A value or an Error. Never both, never neither. Not thread-safe, like any value.
template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value)
      : state_(std::in_place_index<0>, std::move(value)) {}  // NOLINT(google-explicit-constructor)
  Result(Error error)
      : state_(std::in_place_index<1>, std::move(error)) {}  // NOLINT(google-explicit-constructor)

  bool has_value() const { return state_.index() == 0; }
  explicit operator bool() const { return has_value(); }

  T& value() & { return assert(has_value()), std::get<0>(state_); }
  const T& value() const& { return assert(has_value()), std::get<0>(state_); }
  T&& value() && { return assert(has_value()), std::get<0>(std::move(state_)); }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }

  const Error& error() const& { return assert(!has_value()), std::get<1>(state_); }
  Error&& error() && { return assert(!has_value()), std::get<1>(std::move(state_)); }

 private:
  std::variant<T, Error> state_;
};

template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  bool has_value() const { return !error_.has_value(); }
  explicit operator bool() const { return has_value(); }
  const Error& error() const& { return assert(error_), *error_; }
  Error&& error() && { return assert(error_), std::move(*error_); }

 private:
  std::optional<Error> error_;
};

/// Returns from the function with the error of `expression`, a Result<void>.
#define MIXRIG_TRY(expression)                                     \
  do {                                                             \
    if (auto mixrig_try_result = (expression); !mixrig_try_result) \
      return std::move(mixrig_try_result).error();                 \
  } while (false)

#define MIXRIG_CONCAT_INNER(a, b) a##b
#define MIXRIG_CONCAT(a, b) MIXRIG_CONCAT_INNER(a, b)
/// `MIXRIG_ASSIGN(auto x, f());` declares x from f()'s value or returns f()'s error.
#define MIXRIG_ASSIGN(declaration, expression)                         \
  auto MIXRIG_CONCAT(mixrig_result_, __LINE__) = (expression);         \
  if (!MIXRIG_CONCAT(mixrig_result_, __LINE__))                        \
    return std::move(MIXRIG_CONCAT(mixrig_result_, __LINE__)).error(); \
  declaration = *std::move(MIXRIG_CONCAT(mixrig_result_, __LINE__))

}  // namespace mixrig

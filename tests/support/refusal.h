// SPDX-License-Identifier: Apache-2.0
// Checks that something is refused, with one line that has the decisive words.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "hal/base/result.h"

namespace mixrig::test {

/// Whether `result` is an error whose text is one line that contains all `words`; if `code` is
/// given, also of that code.
template <typename T>
testing::AssertionResult refused(const Result<T>& result,
                                 std::initializer_list<std::string_view> words,
                                 std::optional<ErrorCode> code = std::nullopt) {
  if (result) return testing::AssertionFailure() << "it was accepted";
  const std::string& line = result.error().context;
  if (code && result.error().code != *code)
    return testing::AssertionFailure() << "of another code: " << line;
  if (line.find('\n') != std::string::npos)
    return testing::AssertionFailure() << "of several lines: " << line;
  for (const std::string_view word : words)
    if (line.find(word) == std::string::npos)
      return testing::AssertionFailure() << "\"" << word << "\" is not in: " << line;
  return testing::AssertionSuccess();
}

}  // namespace mixrig::test

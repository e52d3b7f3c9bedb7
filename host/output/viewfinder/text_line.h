// SPDX-License-Identifier: Apache-2.0
// A line of text in fixed memory.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace mixrig::viewfinder {

/// Text that is too long is cut off. Never allocates.
class TextLine {
 public:
  template <typename... Args>
  void set(fmt::format_string<Args...> format, Args&&... args) {
    const auto made =
        fmt::format_to_n(chars_.data(), chars_.size(), format, std::forward<Args>(args)...);
    size_ = std::min(chars_.size(), made.size);
  }
  void clear() { size_ = 0; }
  bool empty() const { return size_ == 0; }
  std::string_view view() const { return {chars_.data(), size_}; }

 private:
  std::array<char, 160> chars_{};
  std::size_t size_ = 0;
};

}  // namespace mixrig::viewfinder

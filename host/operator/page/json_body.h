// SPDX-License-Identifier: Apache-2.0
// Reads the JSON object of a request key by key; keys that nobody reads are refused. Pure.
#pragma once

#include <array>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "hal/base/result.h"

namespace mixrig::page {

bool is_utf8(std::string_view text);

/// JSON on one line; bytes that are not UTF-8 become U+FFFD.
std::string to_text(const nlohmann::json& json);
/// Parses JSON from an untrusted text, at most 8 deep. Errors: kUsage.
Result<nlohmann::json> parse_json(std::string_view text);

/// Getters keep the first fault, which done() returns. Keys that no getter asked for are faults.
class Body {
 public:
  /// An empty text is {}. Errors: kUsage.
  static Result<Body> parse(std::string_view text);

  template <int N>
  std::optional<Eigen::Matrix<double, N, 1>> numbers(const char* key, double least,
                                                     double most) const {
    const nlohmann::json* value = find(key);
    if (value == nullptr) return std::nullopt;
    Eigen::Matrix<double, N, 1> out;
    bool fine = value->is_array() && value->size() == N;
    for (std::size_t i = 0; fine && i < N; ++i) {
      fine = (*value)[i].is_number();
      if (!fine) break;
      out[static_cast<int>(i)] = (*value)[i].get<double>();
      fine = out[static_cast<int>(i)] >= least && out[static_cast<int>(i)] <= most;
    }
    if (fine) return out;
    fail(key, range_text(N, least, most));
    return std::nullopt;
  }
  std::optional<double> number(const char* key, double least, double most) const;
  std::optional<bool> boolean(const char* key) const;
  std::optional<std::string> text(const char* key, std::size_t most_bytes) const;
  /// Text that is_name() accepts.
  std::optional<std::string> name(const char* key) const;

  /// Notes a fault; only the first one is kept.
  void fail(const std::string& key, const std::string& what) const;
  template <typename T>
  Result<T> done(T value) const {
    if (auto fault = first_fault()) return *std::move(fault);
    return value;
  }

 private:
  const nlohmann::json* find(const char* key) const;
  std::optional<Error> first_fault() const;
  static std::string range_text(int count, double least, double most);

  nlohmann::json json_;
  mutable std::set<std::string> known_;
  mutable std::optional<Error> fault_;
};

}  // namespace mixrig::page

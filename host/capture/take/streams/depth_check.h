// SPDX-License-Identifier: Apache-2.0
// Depth that cannot be what the take says: a wrong unit, steps that mean nothing. Private to this
// module.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "hal/base/image.h"
#include "host/capture/take/streams/depth_steps.h"

namespace mixrig::take {

/// Looks at the first pictures of a depth stream and warns of each fault once. Not thread-safe.
class DepthCheck {
 public:
  /// `where` begins each line, such as "t/take.toml: [depth]".
  explicit DepthCheck(std::string where) : where_(std::move(where)) {}

  /// Returns whether further pictures are examined.
  bool wants_more() const { return looked_ < kPictures; }
  /// Examines a picture in steps, and in metres as they were read.
  void look(const Image<std::uint16_t>& steps, const Steps& meaning, const Image<float>& depth_m);
  /// Examines a picture that has no steps.
  void look(const Image<float>& depth_m);
  /// Returns the warnings so far, in the order of the pictures; each was logged once.
  const std::vector<std::string>& found() const { return found_; }

 private:
  static constexpr int kPictures = 5;
  enum class Fault { kStretched, kOnes, kUnknown, kRange };
  /// Logs the first warning of each fault; its numbers differ from picture to picture.
  void note(Fault fault, const std::string& what);
  void check_steps(const Image<std::uint16_t>& steps, const Steps& meaning);
  void check_range(const Image<float>& depth_m);

  std::string where_;
  std::vector<std::string> found_;
  std::array<bool, 4> told_{};  ///< by Fault
  std::vector<std::uint32_t> histogram_;
  std::vector<float> known_m_;
  int looked_ = 0;
};

}  // namespace mixrig::take

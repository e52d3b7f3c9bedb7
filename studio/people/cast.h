// SPDX-License-Identifier: Apache-2.0
// The people of a take: who they are and where they are at a time.
#pragma once

#include "studio/stage/materials.h"
#include "studio/stage/posture.h"

namespace mixrig::studio {

struct Layout;

/// One to three people. The first is the person of the scenario; the second sits; the third walks
/// half a lap away, or stands where the first does not walk, in clothes of the wall's colour. And
/// the crowd of the day.
/// Immutable and thread-safe.
class Cast {
 public:
  Cast(const StudioOptions& options, const Layout& layout, double start_s);

  /// Adds all bodies with what they wear and carry.
  void build(double time_s, Mesh& mesh) const;
  const PersonMotion& first() const { return people_.front(); }
  const std::vector<PersonMotion>& people() const { return people_; }
  /// Clothes of the others, in order.
  static void dress(const StudioOptions& options, Materials& materials);

 private:
  void add_third(const StudioOptions& options, const Layout& layout, double start_s);

  StudioOptions options_;
  std::vector<PersonMotion> people_;
};

}  // namespace mixrig::studio

// SPDX-License-Identifier: Apache-2.0
// Decides whether an answer can be trusted, and how well it is known. Private to this module.
#pragma once

#include <string>
#include <vector>

#include "hal/base/result.h"
#include "host/room/registration/answers.h"
#include "host/room/registration/fit.h"

namespace mixrig::model {

/// Error kData, "the rooms cannot be joined: WHY: WHAT TO DO".
Error refusal(const std::string& why, const std::string& what_to_do);

/// Sorts answers that the surfaces do not distinguish: the one whose colours match best comes
/// first.
void order_by_color(std::vector<Answer>& answers);

/// Refuses an answer that is not is_plausible(), and, unless `is_near`, one that agrees in its
/// surfaces but not in its colours.
Result<void> check_evidence(const Answer& best, bool is_near);

/// Evidence of the best other answer over that of the first; 0: there is none. Refuses if another
/// answer fits nearly as well and colours do not decide.
Result<double> check_rivals(const std::vector<Answer>& answers);

/// Refuses if no surface constrains a direction, and, unless `is_near`, if only one wall does: the
/// wall at either end of a hall can be matched with the other, with nothing left to check it.
/// Returns the least share of constraining places when one wall is left out.
Result<double> check_hold(const std::vector<FitRow>& rows, const std::vector<int>& units,
                          bool is_near);

}  // namespace mixrig::model

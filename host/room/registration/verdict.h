// SPDX-License-Identifier: Apache-2.0
// Whether an answer can be trusted, and how well it is known. Private to this module.
#pragma once

#include <string>
#include <vector>

#include "hal/base/result.h"
#include "host/room/registration/answers.h"
#include "host/room/registration/fit.h"

namespace mixrig::model {

/// "the rooms cannot be joined: WHY: WHAT TO DO", kData.
Error refusal(const std::string& why, const std::string& what_to_do);

/// Among answers that the surfaces do not tell apart, the one whose colours fit best comes first.
void order_by_color(std::vector<Answer>& answers);

/// Refuses what is_plausible() does not hold of, and, unless `is_near`, what agrees in its surfaces
/// and not in its colours.
Result<void> check_evidence(const Answer& best, bool is_near);

/// Evidence of the best of the other answers over that of the first, 0: there is none. Refuses
/// where another one fits nearly as well and colours do not decide.
Result<double> check_rivals(const std::vector<Answer>& answers);

/// Refuses where no surface holds a direction, and, unless `is_near`, where one wall alone holds
/// it: the wall at either end of a hall can be laid onto the other with nothing left to check it
/// by. Returns the least hold when one wall is left out.
Result<double> check_hold(const std::vector<FitRow>& rows, const std::vector<int>& units,
                          bool is_near);

}  // namespace mixrig::model

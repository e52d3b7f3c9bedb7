// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
inline auto bad_now() { return std::chrono::system_clock::now(); }

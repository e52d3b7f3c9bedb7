// SPDX-License-Identifier: Apache-2.0
inline std::thread bare(void (*work)()) {
  return std::thread([work] { work(); });
}

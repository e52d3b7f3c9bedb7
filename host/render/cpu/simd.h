// SPDX-License-Identifier: Apache-2.0
// Short vectors of the compiler (GCC and clang): portable, split where the machine's are shorter.
#pragma once

#include <cstdint>
#include <cstring>

namespace mixrig::render::cpu {

using F4 = float __attribute__((vector_size(16)));
using I4 = std::int32_t __attribute__((vector_size(16)));
using U16x4 = std::uint16_t __attribute__((vector_size(8)));
using F16 = float __attribute__((vector_size(64)));
using I16 = std::int32_t __attribute__((vector_size(64)));

template <typename V>
V load(const void* from) {
  V v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
template <typename V>
void store(void* to, V v) {
  std::memcpy(to, &v, sizeof v);
}

}  // namespace mixrig::render::cpu

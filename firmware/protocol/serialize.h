// SPDX-License-Identifier: Apache-2.0
// Writes and reads a message by walking its fields(): little-endian, no padding, exact length.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>
#include <type_traits>
#include <utility>

namespace mixrig::protocol {

namespace detail {
template <typename T>
struct WireSize : std::integral_constant<std::size_t, sizeof(T)> {
  static_assert(std::is_unsigned_v<T> || std::is_enum_v<T>, "unsigned, enum or array of them");
};
template <typename T, std::size_t N>
struct WireSize<std::array<T, N>> : std::integral_constant<std::size_t, N * WireSize<T>::value> {};

template <typename T>
constexpr std::uint8_t* put(std::uint8_t* at, const T& value) {
  auto bits = static_cast<std::uint64_t>(value);
  for (std::size_t i = 0; i < sizeof(T); ++i, bits >>= 8) *at++ = static_cast<std::uint8_t>(bits);
  return at;
}
template <typename T, std::size_t N>
constexpr std::uint8_t* put(std::uint8_t* at, const std::array<T, N>& values) {
  for (const T& value : values) at = put(at, value);
  return at;
}

template <typename T>
constexpr const std::uint8_t* get(const std::uint8_t* at, T& value) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) bits |= static_cast<std::uint64_t>(*at++) << (8 * i);
  value = static_cast<T>(bits);
  return at;
}
template <typename T, std::size_t N>
constexpr const std::uint8_t* get(const std::uint8_t* at, std::array<T, N>& values) {
  for (T& value : values) at = get(at, value);
  return at;
}

template <typename M>
using Fields = decltype(M::fields(std::declval<M&>()));

template <typename M, std::size_t... I>
constexpr auto sizes_of(std::index_sequence<I...>) {
  return std::array<std::size_t, sizeof...(I)>{
      WireSize<std::remove_cvref_t<std::tuple_element_t<I, Fields<M>>>>::value...};
}
}  // namespace detail

/// Sizes in bytes of the fields of message M, in wire order.
template <typename M>
constexpr auto field_sizes() {
  return detail::sizes_of<M>(std::make_index_sequence<std::tuple_size_v<detail::Fields<M>>>{});
}

/// Bytes of the body of message M.
template <typename M>
constexpr std::size_t wire_size() {
  std::size_t sum = 0;
  for (const std::size_t size : field_sizes<M>()) sum += size;
  return sum;
}

/// Writes `message`; `out` has at least wire_size<M>() bytes. Returns the bytes written.
template <typename M>
constexpr std::size_t write_message(const M& message, std::span<std::uint8_t> out) {
  std::uint8_t* at = out.data();
  std::apply([&](const auto&... field) { ((at = detail::put(at, field)), ...); },
             M::fields(message));
  return wire_size<M>();
}

/// Reads `message`; false where the length is not exactly that of M.
template <typename M>
constexpr bool read_message(std::span<const std::uint8_t> body, M& message) {
  if (body.size() != wire_size<M>()) return false;
  const std::uint8_t* at = body.data();
  std::apply([&](auto&... field) { ((at = detail::get(at, field)), ...); }, M::fields(message));
  return true;
}

}  // namespace mixrig::protocol

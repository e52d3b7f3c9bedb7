// SPDX-License-Identifier: Apache-2.0
// Writes TOML files. The program writes TOML only through this class.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "hal/base/image.h"

namespace mixrig::config {

/// One table of a TOML file; the root table is the file. Keys are written in the order in which
/// they were set, but values before tables. Text and keys are escaped; a number is written with the
/// fewest digits that read back as the same double. Precondition: numbers are finite, because Table
/// refuses others, and a key is set to either a value or a table. Not thread-safe.
class Writer {
 public:
  Writer();
  Writer(Writer&&) noexcept;
  Writer& operator=(Writer&&) noexcept;
  ~Writer();

  /// Sets a value, or replaces it.
  Writer& set(std::string_view key, std::string_view text);
  /// Without it a literal would become a bool.
  Writer& set(std::string_view key, const char* text);
  Writer& set(std::string_view key, bool value);
  Writer& set(std::string_view key, int value);
  Writer& set(std::string_view key, double value);
  Writer& set(std::string_view key, Size size);  ///< [width, height]
  Writer& set(std::string_view key, std::span<const int> values);
  Writer& set(std::string_view key, std::span<const double> values);
  /// `values` row by row, as arrays of `columns` numbers.
  Writer& set_matrix(std::string_view key, std::size_t columns, std::span<const double> values);
  /// Adds the table [key].
  Writer& set(std::string_view key, Writer table);
  /// Adds a table [[key]]: appends to the array of tables of that name.
  Writer& add(std::string_view key, Writer table);

  /// Returns the table as TOML.
  std::string text() const;

 private:
  struct State;
  Writer& set_text(std::string_view key, std::string value);
  std::unique_ptr<State> state_;
};

/// `value` rounded to that many significant decimal digits, 1 to 17.
double rounded(double value, int significant_digits);

}  // namespace mixrig::config

// SPDX-License-Identifier: Apache-2.0
// Reads YAML files of other tools: typed values, and a one-line error. Private to this module.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <yaml-cpp/yaml.h>

#include "hal/base/result.h"

namespace mixrig::calibration_file {

/// A mapping of a YAML file. Getters do not fail at once: the document notes the first thing that
/// is wrong, the getter returns a default, and finish() of the document returns the error. Not
/// thread-safe.
class YamlTable {
 public:
  bool present() const { return node_.IsDefined() && node_.IsMap(); }
  bool has(const std::string& key) const;
  /// Returns the first of `keys` that the file has, else the first of `keys`.
  std::string first_of(std::initializer_list<const char*> keys) const;

  std::string text(const std::string& key) const;
  std::string text_or(const std::string& key, const std::string& fallback) const;
  double number(const std::string& key, double min, double max) const;
  double number_or(const std::string& key, double fallback, double min, double max) const;
  /// Reads a list of `min_count` to `max_count` finite numbers.
  std::vector<double> numbers(const std::string& key, std::size_t min_count,
                              std::size_t max_count) const;
  /// Reads a list of `size` lists of `size` numbers; 0 x 0 where absent.
  Eigen::MatrixXd square_or_empty(const std::string& key, int size) const;
  /// Reads the numbers of an OpenCV or ROS matrix {rows, cols, data}, row by row.
  std::vector<double> matrix_data(const std::string& key, std::size_t min_count,
                                  std::size_t max_count) const;
  YamlTable table(const std::string& key) const;           ///< may be absent
  YamlTable required_table(const std::string& key) const;  ///< noted where absent

  /// Notes "FILE:LINE: key "KEY": WHAT".
  void fail(const std::string& key, const std::string& what) const;

 private:
  friend class YamlDocument;
  struct Notes {
    std::string file;
    std::optional<std::string> first_error;
  };
  YamlTable(std::shared_ptr<Notes> notes, YAML::Node node, std::string name)
      : notes_(std::move(notes)), node_(std::move(node)), name_(std::move(name)) {}
  YAML::Node find(const std::string& key) const;
  std::optional<double> finite(const YAML::Node& node) const;
  void note(const YAML::Node& node, const std::string& key, const std::string& what) const;

  std::shared_ptr<Notes> notes_;
  YAML::Node node_;
  std::string name_;
};

class YamlDocument {
 public:
  static constexpr std::size_t kMaxBytes = std::size_t{4} << 20;
  /// Errors: kFormat (file:line) for what is no YAML mapping or larger than kMaxBytes.
  static Result<YamlDocument> parse(const std::string& text, const std::string& name);
  YamlTable root() const { return {notes_, root_, ""}; }
  /// Errors: kFormat, the first noted error.
  Result<void> finish() const;

 private:
  std::shared_ptr<YamlTable::Notes> notes_;
  YAML::Node root_;
};

}  // namespace mixrig::calibration_file

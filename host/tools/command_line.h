// SPDX-License-Identifier: Apache-2.0
// Options of subcommands. command_line.cpp alone compiles the parser (CLI11).
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace mixrig::tools {

/// Text of --help about an option or a positional argument.
struct OptionText {
  std::vector<std::string> names;   ///< "-v", "--verbose"; empty for a positional argument
  std::string positional;           ///< "SCENE"; empty for an option
  std::string type;                 ///< "TEXT", "INT", "FLOAT", "UINT"; empty for a flag
  std::string limits;               ///< "0 to 256"; empty where any value of the type is allowed
  std::vector<std::string> values;  ///< the allowed words; empty where they are not enumerated
  std::string fallback;  ///< value without the option; where `may_be_bare`, value of the option
                         ///< given without one
  std::string about, group;
  std::vector<std::string> excludes;  ///< options that exclude it
  bool required = false;
  bool several = false;      ///< takes more than one value
  bool may_be_bare = false;  ///< the value may be left out
};

/// Text of --help about a command. Hidden subcommands are left out.
struct CommandText {
  std::string name, about;
  std::vector<OptionText> options;  ///< positional arguments first, in their order
  std::vector<CommandText> commands;
};

/// Handle of a command's option, valid as long as its CommandLine. Each call returns the handle.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}

  Option required();
  /// The value must lie in low..high.
  Option range(int low, int high);
  Option range(double low, double high);
  Option non_negative();
  Option positive();
  Option one_of(const std::vector<std::string>& values);
  Option excludes(Option other);
  /// --help shows the value that the variable holds now.
  Option show_default();
  Option group(const std::string& heading);
  /// The value may be left out; it is `value` then.
  Option value_if_left_out(const std::string& value);
  /// A value that begins with `prefix` is given without it.
  Option without_prefix(const std::string& prefix);

 private:
  CLI::Option* option_;
};

/// Handle of a command or subcommand, valid as long as its CommandLine.
class Command {
 public:
  explicit Command(CLI::App* app) : app_(app) {}

  /// NAME or -v,--verbose and the variable that the value is written to; it must outlive the parse.
  /// Empty texts and numbers that are not finite are refused.
  Option add_option(const std::string& name, std::string& value, const std::string& about);
  Option add_option(const std::string& name, std::vector<std::string>& values,
                    const std::string& about);
  Option add_option(const std::string& name, int& value, const std::string& about);
  Option add_option(const std::string& name, unsigned& value, const std::string& about);
  Option add_option(const std::string& name, std::size_t& value, const std::string& about);
  Option add_option(const std::string& name, double& value, const std::string& about);
  Option add_option(const std::string& name, std::optional<double>& value,
                    const std::string& about);
  Option add_flag(const std::string& name, bool& value, const std::string& about);

  Command add_subcommand(const std::string& name, const std::string& about);
  /// The subcommand `name`, shared by several files: the first call makes it.
  Command group(const std::string& name, const std::string& about);
  void require_subcommand();
  std::vector<Command> subcommands() const;
  bool has_option(const std::string& name) const;
  /// The heading of --help under which the command stands.
  void heading(const std::string& text);
  /// Keeps the command out of --help, of error lines and of text().
  void hide();
  /// Takes options and arguments that it does not have, and leaves them unread.
  void accept_anything();
  CommandText text() const;
  /// Number of times the option was given; valid while and after the line is parsed.
  std::size_t count(const std::string& name) const;
  /// Called when the command was chosen and its values are written.
  void callback(std::function<void()> chosen);

 private:
  CLI::App* app_;
};

/// Parser of the command line. One thread.
class CommandLine {
 public:
  CommandLine(const std::string& about, const std::string& name, const std::string& version);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  Command root();
  struct Parsed {
    bool done = false;  ///< --help or --version: printed, nothing is left to do
    std::string error;  ///< one line; empty for a good command line
  };
  Parsed parse(int argc, const char* const* argv);

 private:
  std::unique_ptr<CLI::App> app_;
};

}  // namespace mixrig::tools

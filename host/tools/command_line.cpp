// SPDX-License-Identifier: Apache-2.0
#include "host/tools/command_line.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <type_traits>
#include <utility>

#include <CLI/CLI.hpp>

#include "host/math/config/nearest.h"

namespace mixrig::tools {
namespace {

/// Refuses what is no number, such as one with a unit, and "nan" and "inf", which CLI11 reads.
std::string refuse_what_is_not_finite(const std::string& text) {
  double value = 0;
  if (!CLI::detail::lexical_cast(text, value)) return text + " is no number";
  return std::isfinite(value) ? std::string() : text + " is not a finite number";
}

template <typename T>
Option add_number(CLI::App* app, const std::string& name, T& value, const std::string& about) {
  return Option(
      app->add_option(name, value, about)->check(CLI::Validator(refuse_what_is_not_finite, "")));
}

/// Refuses what is no number of type T in the range, in the help's words for such a range.
template <typename T>
CLI::Validator in_range(T low, T high) {
  const auto refuse = [low, high](const std::string& text) {
    T value{};
    if (CLI::detail::lexical_cast(text, value) && value >= low && value <= high)
      return std::string();
    std::ostringstream line;
    line << text << " is no " << (std::is_integral_v<T> ? "whole " : "") << "number from " << low
         << " to " << high;
    return line.str();
  };
  return {refuse, CLI::Range(low, high).get_description()};
}

/// Refuses what is no whole number, or none that T holds.
template <typename T>
std::string refuse_what_is_not_whole(const std::string& text) {
  T value{};
  return CLI::detail::lexical_cast(text, value) ? std::string()
                                                : text + " is no whole number, or too large";
}

/// Refuses an empty text, which an unset variable of a shell gives.
std::string refuse_what_is_empty(const std::string& text) {
  return text.empty() ? "the value must not be empty" : std::string();
}

template <typename T>
Option add(CLI::App* app, const std::string& name, T& value, const std::string& about) {
  return Option(app->add_option(name, value, about));
}

template <typename T>
Option add_whole(CLI::App* app, const std::string& name, T& value, const std::string& about) {
  return Option(
      app->add_option(name, value, about)->check(CLI::Validator(refuse_what_is_not_whole<T>, "")));
}

bool is_hidden(const CLI::App& app) { return app.get_group().empty(); }

/// Splits what CLI11 says of a type and its checks: "TEXT:{auto,gles,cpu}", "INT:INT in [0 - 256]".
void read_type(const std::string& text, OptionText& option) {
  const std::size_t colon = text.find(':');
  option.type = text.substr(0, colon);
  if (colon == std::string::npos) return;
  std::string check = text.substr(colon + 1);
  const std::size_t open = check.find(" in [");
  if (check.starts_with("{") && check.ends_with("}")) {
    check = check.substr(1, check.size() - 2);
    for (std::size_t comma = check.find(','); comma != std::string::npos; comma = check.find(',')) {
      option.values.push_back(check.substr(0, comma));
      check.erase(0, comma + 1);
    }
    option.values.push_back(check);
  } else if (open != std::string::npos) {
    option.limits = check.substr(open + 5, check.find(']', open) - open - 5);
    option.limits.replace(option.limits.find(" - "), 3, " to ");
  } else if (check.starts_with("NONNEGATIVE")) {
    option.limits = "0 or more";
  } else if (check.starts_with("POSITIVE")) {
    option.limits = "above 0";
  }
}

OptionText text_of(const CLI::Option& option) {
  OptionText text;
  for (const std::string& name : option.get_snames()) text.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) text.names.push_back("--" + name);
  if (text.names.empty()) text.positional = option.get_name(true);
  text.about = option.get_description();
  text.group = option.get_group() == "Options" ? "" : option.get_group();
  text.required = option.get_required();
  for (const CLI::Option* other : option.get_excludes()) text.excludes.push_back(other->get_name());
  if (option.get_type_size_max() == 0 || option.get_items_expected_max() == 0) return text;  // flag
  read_type(option.get_type_name(), text);
  text.fallback = option.get_default_str();
  text.several = option.get_expected_max() > 1;
  text.may_be_bare = option.get_expected_min() == 0;
  return text;
}

CommandText text_of(const CLI::App& app) {
  CommandText text{app.get_name(), app.get_description(), {}, {}};
  for (const bool positional : {true, false})
    for (const CLI::Option* option : app.get_options({}))
      if (option->get_positional() == positional && !option->get_group().empty())
        text.options.push_back(text_of(*option));
  for (const CLI::App* child : app.get_subcommands({}))
    if (!is_hidden(*child)) text.commands.push_back(text_of(*child));
  return text;
}

std::vector<std::string> names_of_options(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options({}))
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& known) {
  const auto meant = config::nearest(word, known);
  return meant ? " (did you mean " + *meant + "?)" : "";
}

/// What is wrong with the arguments of a command that has no subcommand left to choose.
std::string wrong_argument(const CLI::App& command, const std::vector<std::string>& rest,
                           const CLI::ParseError& error) {
  if (error.get_exit_code() != static_cast<int>(CLI::ExitCodes::ExtrasError)) return error.what();
  const auto is_option = [](const std::string& word) { return word.starts_with("-"); };
  const auto option = std::ranges::find_if(rest, is_option);
  if (option != rest.end()) {
    const std::string name = option->substr(0, option->find('='));
    return name + " is no option" + did_you_mean(name, names_of_options(command));
  }
  return rest.empty() ? error.what() : "'" + rest.front() + "' is one argument too many";
}

std::string usage_line(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App* chosen = &app;
  std::string name;
  while (!chosen->get_subcommands().empty()) {
    chosen = chosen->get_subcommands().front();
    name += (name.empty() ? "" : " ") + chosen->get_name();
  }
  std::vector<std::string> known;
  for (const CLI::App* command : chosen->get_subcommands({}))
    if (!is_hidden(*command)) known.push_back(command->get_name());
  const auto rest = app.remaining(true);
  if (known.empty())
    return name + ": " + wrong_argument(*chosen, rest, error) + ": see mixrig " + name + " --help";
  std::string line = name.empty() ? "" : name + ": ";
  line += rest.empty() ? "no command given"
                       : "unknown command " + rest.front() + did_you_mean(rest.front(), known);
  line += ": use one of";
  for (const std::string& command : known) line += " " + command;
  return line;
}

}  // namespace

Option Option::required() { return Option(option_->required()); }
Option Option::range(int low, int high) { return Option(option_->check(in_range(low, high))); }
Option Option::range(double low, double high) {
  return Option(option_->check(in_range(low, high)));
}
Option Option::non_negative() { return Option(option_->check(CLI::NonNegativeNumber)); }
Option Option::positive() { return Option(option_->check(CLI::PositiveNumber)); }
Option Option::one_of(const std::vector<std::string>& values) {
  return Option(option_->check(CLI::IsMember(values)));
}
Option Option::excludes(Option other) { return Option(option_->excludes(other.option_)); }
Option Option::show_default() { return Option(option_->capture_default_str()); }
Option Option::group(const std::string& heading) { return Option(option_->group(heading)); }
Option Option::value_if_left_out(const std::string& value) {
  return Option(option_->expected(0, 1)->default_str(value));
}

Option Option::without_prefix(const std::string& prefix) {
  return Option(option_->transform([prefix](std::string text) {
    return text.starts_with(prefix) ? text.substr(prefix.size()) : text;
  }));
}

Option Command::add_option(const std::string& name, std::string& value, const std::string& about) {
  return Option(
      app_->add_option(name, value, about)->check(CLI::Validator(refuse_what_is_empty, "")));
}
Option Command::add_option(const std::string& name, std::vector<std::string>& values,
                           const std::string& about) {
  return add(app_, name, values, about);
}
Option Command::add_option(const std::string& name, int& value, const std::string& about) {
  return add_whole(app_, name, value, about);
}
Option Command::add_option(const std::string& name, unsigned& value, const std::string& about) {
  return add_whole(app_, name, value, about);
}
Option Command::add_option(const std::string& name, std::size_t& value, const std::string& about) {
  return add_whole(app_, name, value, about);
}
Option Command::add_option(const std::string& name, double& value, const std::string& about) {
  return add_number(app_, name, value, about);
}
Option Command::add_option(const std::string& name, std::optional<double>& value,
                           const std::string& about) {
  return add_number(app_, name, value, about);
}
Option Command::add_flag(const std::string& name, bool& value, const std::string& about) {
  return Option(app_->add_flag(name, value, about));
}

Command Command::add_subcommand(const std::string& name, const std::string& about) {
  return Command(app_->add_subcommand(name, about));
}

Command Command::group(const std::string& name, const std::string& about) {
  for (CLI::App* known : app_->get_subcommands({}))
    if (known->get_name() == name) return Command(known);
  Command made = add_subcommand(name, about);
  made.require_subcommand();
  return made;
}

void Command::require_subcommand() { app_->require_subcommand(1); }

std::vector<Command> Command::subcommands() const {
  std::vector<Command> commands;
  for (CLI::App* child : app_->get_subcommands({})) commands.emplace_back(child);
  return commands;
}

bool Command::has_option(const std::string& name) const {
  return app_->get_option_no_throw(name) != nullptr;
}

void Command::heading(const std::string& text) { app_->group(text); }

void Command::hide() { app_->group(""); }

void Command::accept_anything() { app_->allow_extras(); }

CommandText Command::text() const { return text_of(*app_); }

std::size_t Command::count(const std::string& name) const { return app_->count(name); }

void Command::callback(std::function<void()> chosen) { app_->callback(std::move(chosen)); }

CommandLine::CommandLine(const std::string& about, const std::string& name,
                         const std::string& version)
    : app_(std::make_unique<CLI::App>(about, name)) {
  app_->require_subcommand(1);
  app_->set_version_flag("--version", version);
}

CommandLine::~CommandLine() = default;

Command CommandLine::root() { return Command(app_.get()); }

CommandLine::Parsed CommandLine::parse(int argc, const char* const* argv) {
  try {
    app_->parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) {
      app_->exit(error);
      return {true, {}};
    }
    return {false, usage_line(*app_, error)};
  }
  return {};
}

}  // namespace mixrig::tools

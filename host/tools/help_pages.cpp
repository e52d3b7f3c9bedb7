// SPDX-License-Identifier: Apache-2.0
// mixrig help-pages DIR: the command line as commands.md, man pages and completions of three
// shells.
#include <filesystem>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "hal/base/partial_path.h"
#include "host/tools/completions.h"

namespace mixrig::tools {
namespace {

/// A command before its subcommands.
void collect_help(const CommandText& text, std::vector<std::string> path,
                  std::vector<HelpEntry>& entries) {
  entries.push_back({path, &text});
  for (const CommandText& child : text.commands) {
    path.push_back(child.name);
    collect_help(child, path, entries);
    path.pop_back();
  }
}

/// -h, -v, --json and --version, which are described once for all commands.
bool is_common(const OptionText& option) {
  if (option.names.empty()) return false;
  const std::string& last = option.names.back();
  return last == "--help" || last == "--verbose" || last == "--version" ||
         (last == "--json" && option.fallback.empty());
}

/// "--threads INT", "--view [TEXT]", "-v, --verbose", "SCENE".
std::string signature(const OptionText& option) {
  if (option.names.empty()) return option.positional + (option.several ? " ..." : "");
  std::string text = fmt::format("{}", fmt::join(option.names, ", "));
  if (option.type.empty()) return text;
  std::string value =
      option.values.empty() ? option.type : fmt::format("{}", fmt::join(option.values, "|"));
  if (option.several) value += " ...";
  return text + (option.may_be_bare ? " [" + value + "]" : " " + value);
}

/// Everything of an option that its signature does not say.
std::string details(const OptionText& option) {
  std::string text;
  if (option.required) text += "required; ";
  if (!option.limits.empty()) text += option.limits + "; ";
  if (!option.fallback.empty())
    text += (option.may_be_bare ? "without a value " : "default ") + option.fallback + "; ";
  if (!option.excludes.empty())
    text += fmt::format("not with {}; ", fmt::join(option.excludes, ", "));
  return text.empty() ? option.about : "(" + text.substr(0, text.size() - 2) + ") " + option.about;
}

std::string synopsis(const HelpEntry& entry) {
  std::string text = entry.command(' ') + " [OPTIONS]";
  for (const OptionText& option : entry.text->options)
    if (option.names.empty())
      text += option.required ? " " + signature(option) : " [" + signature(option) + "]";
  return entry.text->commands.empty() ? text : text + " COMMAND";
}

/// Lines of at most 110 characters; no line begins with what Markdown takes for a list.
std::string wrapped(const std::string& text, const std::string& indent) {
  constexpr std::size_t kMostColumns = 110;
  std::istringstream words(text);
  std::string all, line, word;
  while (words >> word) {
    const bool may_begin = word != "-" && word != "+" && word != "*";
    if (!line.empty() && may_begin && line.size() + 1 + word.size() > kMostColumns) {
      all += line + "\n";
      line = indent + word;
    } else {
      line += (line.empty() ? "" : " ") + word;
    }
  }
  return all + line + "\n";
}

// ---- docs/reference/commands.md

void add_markdown_options(const CommandText& command, std::string& out) {
  std::string group;
  for (const OptionText& option : command.options) {
    if (is_common(option)) continue;
    if (option.group != group) out += "\n" + option.group + ":\n\n";
    group = option.group;
    out += wrapped("- `" + signature(option) + "`: " + details(option), "  ");
  }
}

std::string commands_page(const std::vector<HelpEntry>& entries) {
  std::string out =
      "# Commands\n"
      "Written by `mixrig help-pages` from the command line itself; a test compares them.\n"
      "Each command prints the same by `mixrig COMMAND --help`; `man mixrig-COMMAND` has it too.\n"
      "\n"
      "Options of every command:\n"
      "\n"
      "- `-h, --help`: print the options of the command.\n"
      "- `-v, --verbose`: log the steps.\n"
      "- `--json FILE`: write the report of the command to FILE; with `-` the report alone goes "
      "to\n"
      "  stdout, and tables go to stderr.\n"
      "- `--version`, of `mixrig` alone: print version and vector unit.\n"
      "\n"
      "Exit status: 0 done, 1 failed while running (device, data), 2 wrong usage or file. An error "
      "is\n"
      "one line on stderr: what, why, where, and what to do.\n";
  for (const HelpEntry& entry : entries) {
    if (entry.path.empty()) continue;
    out += "\n" + std::string(entry.path.size() + 1, '#') + " " + entry.command(' ') + "\n";
    out += wrapped(entry.text->about + ".", "");
    out += "\n`" + synopsis(entry) + "`\n\n";
    add_markdown_options(*entry.text, out);
    if (out.ends_with("\n\n")) out.pop_back();
  }
  return out;
}

// ---- man pages

std::string roff(std::string text) {
  text = replaced(replaced(std::move(text), "\\", "\\e"), "-", "\\-");
  return text.starts_with(".") || text.starts_with("'") ? "\\&" + text : text;
}

std::string man_page(const HelpEntry& entry) {
  std::string name = entry.command('-'), upper = name;
  for (char& letter : upper)
    if (letter >= 'a' && letter <= 'z') letter = static_cast<char>(letter - 'a' + 'A');
  std::string out = fmt::format(
      ".TH {} 1 \"\" \"mixrig {}\" \"mixrig manual\"\n.ad l\n.SH NAME\n{} \\- {}\n.SH "
      "SYNOPSIS\n.nf\n{}\n.fi\n",
      roff(upper), MIXRIG_VERSION, roff(name), roff(entry.text->about), roff(synopsis(entry)));
  if (!entry.text->commands.empty()) {
    out += ".SH COMMANDS\n";
    for (const CommandText& child : entry.text->commands)
      out += fmt::format(".TP\n.B {}\n{}\n", roff(child.name), roff(child.about));
  }
  out += ".SH OPTIONS\n";
  std::string group;
  for (const OptionText& option : entry.text->options) {
    if (option.group != group) out += ".SS " + roff(option.group) + "\n";
    group = option.group;
    out += fmt::format(".TP\n.B {}\n{}\n", roff(signature(option)), roff(details(option)));
  }
  out += ".SH EXIT STATUS\n0 done, 1 failed while running, 2 wrong usage or file.\n";
  std::vector<std::string> others;
  if (!entry.path.empty()) others.emplace_back("mixrig");
  for (const CommandText& child : entry.text->commands) others.push_back(name + "-" + child.name);
  out += ".SH SEE ALSO\n";
  for (std::size_t i = 0; i < others.size(); ++i)
    out += ".BR " + roff(others[i]) + " (1)" + (i + 1 < others.size() ? ",\n" : "\n");
  return out;
}

Result<nlohmann::json> write_help_pages(const CommandText& root,
                                        const std::filesystem::path& folder) {
  std::vector<HelpEntry> entries;
  collect_help(root, {}, entries);
  std::vector<std::pair<std::string, std::string>> files = {
      {"commands.md", commands_page(entries)},
      {"mixrig.bash", bash_completion(entries)},
      {"_mixrig", zsh_completion(entries)},
      {"mixrig.fish", fish_completion(entries)}};
  for (const HelpEntry& entry : entries)
    files.emplace_back(entry.command('-') + ".1", man_page(entry));
  std::error_code code;
  std::filesystem::create_directories(folder, code);
  for (const auto& [name, text] : files) MIXRIG_TRY(write_file(folder / name, text));
  return nlohmann::json{{"files", files.size()}};
}

}  // namespace

void add_help_pages_command(Command app, Context& context) {
  auto folder = std::make_shared<std::string>();
  Command command = app.add_subcommand(
      "help-pages", "write commands.md, man pages and shell completions of this command line");
  command.hide();
  command.add_option("DIR", *folder, "folder to write into").required();
  command.callback([&context, app, folder] {
    context.action = [app, folder] { return write_help_pages(app.text(), *folder); };
  });
}

}  // namespace mixrig::tools

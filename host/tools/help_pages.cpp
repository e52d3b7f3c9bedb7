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
#include "host/tools/command.h"

namespace mixrig::tools {
namespace {

/// A command with the words that choose it: {"calibrate", "rig"}; none for mixrig itself.
struct HelpEntry {
  std::vector<std::string> path;
  const CommandText* text;
  std::string joined(const char* by) const { return fmt::format("{}", fmt::join(path, by)); }
  /// "mixrig calibrate rig", or with '-' as the name of its man page.
  std::string command(char by) const {
    std::string name = "mixrig";
    for (const std::string& word : path) name += by + word;
    return name;
  }
};

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

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos;
       at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
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

// ---- completion

/// Kind of words that complete the value of an option.
enum class ValueWords { kFlag, kListed, kNumber, kFile };

ValueWords value_of(const OptionText& option) {
  if (option.type.empty()) return ValueWords::kFlag;
  if (!option.values.empty()) return ValueWords::kListed;
  return option.type == "TEXT" ? ValueWords::kFile : ValueWords::kNumber;
}

bool takes_files(const CommandText& command) {
  for (const OptionText& option : command.options)
    if (option.names.empty()) return true;
  return false;
}

std::vector<std::string> option_names(const CommandText& command) {
  std::vector<std::string> names;
  for (const OptionText& option : command.options)
    names.insert(names.end(), option.names.begin(), option.names.end());
  return names;
}

/// The patterns "PATH|NAME" of a case, quoted, of the options whose value is completed that way.
std::string bash_patterns(const HelpEntry& entry, ValueWords value) {
  std::string patterns;
  for (const OptionText& option : entry.text->options)
    if (value_of(option) == value)
      for (const std::string& name : option.names)
        patterns +=
            (patterns.empty() ? "" : "|") + fmt::format("\"{}|{}\"", entry.joined(" "), name);
  return patterns;
}

std::string bash_values(const std::vector<HelpEntry>& entries) {
  std::string out;
  for (const HelpEntry& entry : entries) {
    for (const OptionText& option : entry.text->options)
      if (value_of(option) == ValueWords::kListed)
        for (const std::string& name : option.names)
          out += fmt::format("    \"{}|{}\") _mixrig_words \"{}\"; return ;;\n", entry.joined(" "),
                             name, fmt::join(option.values, " "));
    if (const auto files = bash_patterns(entry, ValueWords::kFile); !files.empty())
      out += "    " + files + ") _mixrig_files; return ;;\n";
    if (const auto numbers = bash_patterns(entry, ValueWords::kNumber); !numbers.empty())
      out += "    " + numbers + ") return ;;\n";
  }
  return out;
}

/// Lines of a case that walk from a command to its subcommand, in a shell's own syntax.
std::string steps(const std::vector<HelpEntry>& entries) {
  std::vector<std::string> known;
  for (const HelpEntry& entry : entries)
    for (const CommandText& child : entry.text->commands)
      known.push_back(fmt::format("\"{}|{}\"", entry.joined(" "), child.name));
  return fmt::format("{}", fmt::join(known, "|"));
}

std::string bash_completion(const std::vector<HelpEntry>& entries) {
  std::string out =
      "# Bash completion of mixrig, written by mixrig help-pages.\n"
      "_mixrig_words() { mapfile -t COMPREPLY < <(compgen -W \"$1\" -- \"$_mixrig_word\"); }\n"
      "_mixrig_files() { mapfile -t COMPREPLY < <(compgen -f -- \"$_mixrig_word\"); }\n"
      "_mixrig() {\n"
      "  local _mixrig_word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]}\n"
      "  local command= files= i\n"
      "  COMPREPLY=()\n"
      "  if [[ $_mixrig_word == = ]]; then\n"
      "    _mixrig_word=\n"
      "  elif [[ $before == = ]]; then\n"
      "    before=${COMP_WORDS[COMP_CWORD - 2]}\n"
      "  fi\n"
      "  for ((i = 1; i < COMP_CWORD; i++)); do\n"
      "    case \"$command|${COMP_WORDS[i]}\" in\n"
      "      " +
      steps(entries) +
      ") command=${command:+$command }${COMP_WORDS[i]} ;;\n"
      "    esac\n"
      "  done\n"
      "  case \"$command|$before\" in\n" +
      bash_values(entries) +
      "  esac\n"
      "  local words=\n"
      "  case \"$command\" in\n";
  for (const HelpEntry& entry : entries) {
    std::vector<std::string> words = option_names(*entry.text);
    for (const CommandText& child : entry.text->commands) words.push_back(child.name);
    out += fmt::format("    \"{}\") words=\"{}\"{} ;;\n", entry.joined(" "), fmt::join(words, " "),
                       takes_files(*entry.text) ? " files=1" : "");
  }
  return out +
         "  esac\n"
         "  if [[ -n $files && $_mixrig_word != -* ]]; then _mixrig_files; else _mixrig_words "
         "\"$words\"; fi\n"
         "}\n"
         "complete -o filenames -F _mixrig mixrig\n";
}

/// Text between single quotes of a shell.
std::string quoted(const std::string& text) { return "'" + replaced(text, "'", "'\\''") + "'"; }

std::string zsh_plain(std::string text) {
  for (const char* special : {"\\", ":", "[", "]"})
    text = replaced(std::move(text), special, std::string("\\") + special);
  return text;
}

std::string zsh_action(const OptionText& option) {
  const std::string name = option.names.empty() ? option.positional : option.type;
  switch (value_of(option)) {
    case ValueWords::kFlag:
      return "";
    case ValueWords::kListed:
      return fmt::format(":{}:({})", name, fmt::join(option.values, " "));
    case ValueWords::kNumber:
      return fmt::format(":{}: ", name);
    case ValueWords::kFile:
      break;
  }
  return fmt::format(":{}:_files", name);
}

std::string zsh_arguments(const CommandText& command) {
  std::string out;
  for (const OptionText& option : command.options)
    for (const std::string& name : option.names) {
      std::string action = zsh_action(option);
      if (option.may_be_bare) action.insert(0, 1, ':');
      out += " \\\n      " + quoted((option.several ? "*" : "") + name + "[" +
                                    zsh_plain(option.about) + "]" + action);
    }
  return out;
}

std::string zsh_command(const HelpEntry& entry) {
  const std::string function = "_mixrig" + (entry.path.empty() ? "" : "_" + entry.joined("_"));
  std::string out = function + "() {\n";
  if (entry.text->commands.empty())
    return out + "  _arguments" + zsh_arguments(*entry.text) +
           (takes_files(*entry.text) ? " \\\n      '*:file:_files'" : "") + "\n}\n";
  out += "  local curcontext=$curcontext state line\n  typeset -A opt_args\n  _arguments -C" +
         zsh_arguments(*entry.text) +
         " \\\n      '1:command:->command' \\\n      '*::argument:->rest'\n"
         "  case $state in\n    command)\n      local -a commands=(\n";
  for (const CommandText& child : entry.text->commands)
    out += "        " + quoted(child.name + ":" + zsh_plain(child.about)) + "\n";
  out += "      )\n      _describe command commands ;;\n    rest)\n      case $line[1] in\n";
  for (const CommandText& child : entry.text->commands)
    out += "        " + child.name + ") " + function + "_" + child.name + " ;;\n";
  return out + "      esac ;;\n  esac\n}\n";
}

std::string zsh_completion(const std::vector<HelpEntry>& entries) {
  std::string out = "#compdef mixrig\n# Zsh completion of mixrig, written by mixrig help-pages.\n";
  for (auto entry = entries.rbegin(); entry != entries.rend(); ++entry) out += zsh_command(*entry);
  return out + "_mixrig \"$@\"\n";
}

std::string fish_option(const HelpEntry& entry, const OptionText& option) {
  std::string line = "complete -c mixrig -n " + quoted("__mixrig_at " + entry.joined(" "));
  for (const std::string& name : option.names)
    line += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  switch (value_of(option)) {
    case ValueWords::kFlag:
      break;
    case ValueWords::kListed:
      line += " -x -a " + quoted(fmt::format("{}", fmt::join(option.values, " ")));
      break;
    case ValueWords::kNumber:
      line += " -x";
      break;
    case ValueWords::kFile:
      line += " -r -F";
      break;
  }
  return line + " -d " + quoted(option.about) + "\n";
}

std::string fish_completion(const std::vector<HelpEntry>& entries) {
  std::string out =
      "# Fish completion of mixrig, written by mixrig help-pages.\n"
      "# True where the words before the cursor choose the command that the arguments name.\n"
      "function __mixrig_at\n"
      "  set -l command\n"
      "  for word in (commandline -opc)[2..-1]\n"
      "    switch \"$command|$word\"\n"
      "      case " +
      replaced(steps(entries), "\"|\"", "\" \"") +
      "\n"
      "        set -a command $word\n"
      "    end\n"
      "  end\n"
      "  test \"$command\" = \"$argv\"\n"
      "end\n"
      "complete -c mixrig -f\n";
  for (const HelpEntry& entry : entries) {
    const std::string at = "complete -c mixrig -n " + quoted("__mixrig_at " + entry.joined(" "));
    for (const CommandText& child : entry.text->commands)
      out += at + " -a " + child.name + " -d " + quoted(child.about) + "\n";
    if (takes_files(*entry.text)) out += at + " -F\n";
    for (const OptionText& option : entry.text->options)
      if (!option.names.empty()) out += fish_option(entry, option);
  }
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

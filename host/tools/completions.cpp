// SPDX-License-Identifier: Apache-2.0
#include "host/tools/completions.h"

#include <utility>

namespace mixrig::tools {

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos;
       at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

namespace {

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

}  // namespace

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

std::string zsh_completion(const std::vector<HelpEntry>& entries) {
  std::string out = "#compdef mixrig\n# Zsh completion of mixrig, written by mixrig help-pages.\n";
  for (auto entry = entries.rbegin(); entry != entries.rend(); ++entry) out += zsh_command(*entry);
  return out + "_mixrig \"$@\"\n";
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

}  // namespace mixrig::tools

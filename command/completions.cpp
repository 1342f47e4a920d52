// SPDX-License-Identifier: Apache-2.0
// Completion in three shells. Each finds the command that the line is at by its words, offers that
// command's own commands and options, values where they are listed, and files elsewhere.
#include <fmt/core.h>

#include "command/command_tree.hpp"

namespace photonloom {
namespace {

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
    text.replace(at, what.size(), by);
  return text;
}

// In the single quotes of bash and zsh.
std::string quoted(const std::string& text) { return "'" + replaced(text, "'", "'\\''") + "'"; }

std::string fish_quoted(const std::string& text) {
  return "'" + replaced(replaced(text, "\\", "\\\\"), "'", "\\'") + "'";
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

void add_word(std::string& words, const std::string& word) {
  words += (words.empty() ? "" : " ") + word;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) add_word(text, word);
  return text;
}

std::string zsh_function(const CommandText& c) { return "_" + replaced(c.path, " ", "_"); }

// How zsh completes a value: ":NAME:(a b)", ":DIR:_files -/" or ":FILE:_files".
std::string zsh_value(const OptionText& o) {
  if (!o.choices.empty()) return fmt::format(":{}:({})", o.value, joined(o.choices));
  return fmt::format(":{}:_files{}", replaced(o.value, ":", "\\:"), o.value == "DIR" ? " -/" : "");
}

}  // namespace

std::string bash_completion(const CommandText& root) {
  std::string paths, offers, values;
  for_each_command(root, [&](const CommandText& c) {
    if (&c != &root) paths += fmt::format("{}'{}'", paths.empty() ? "" : " | ", c.path);
    std::string options, commands, takes;
    for (const CommandText& below : c.commands) add_word(commands, below.name);
    for (const OptionText& o : c.positionals)
      for (const std::string& choice : o.choices) add_word(commands, choice);
    for (const OptionText& o : c.options) {
      for (const std::string& name : o.names) add_word(options, name);
      if (o.value.empty()) continue;
      for (const std::string& name : o.names) {
        if (o.choices.empty())
          takes += fmt::format("{}'{} {}'", takes.empty() ? "" : " | ", c.path, name);
        else
          values +=
              fmt::format("    '{} {}') words='{}' options= ;;\n", c.path, name, joined(o.choices));
      }
    }
    if (!takes.empty()) values += fmt::format("    {}) words= options= ;;\n", takes);
    offers += fmt::format("    '{}') words='{}' options='{}' ;;\n", c.path, commands, options);
  });
  // Where there is nothing to offer, bash completes file names (-o default).
  return fmt::format(
      R"(# SPDX-License-Identifier: Apache-2.0
# Completion of {0} in bash.
_{0}() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} at={0} words= options= i
  for ((i = 1; i < COMP_CWORD; i++)); do
    case "$at ${{COMP_WORDS[i]}}" in
      {1}) at="$at ${{COMP_WORDS[i]}}" ;;
    esac
  done
  case $at in
{2}  esac
  case "$at ${{COMP_WORDS[COMP_CWORD - 1]}}" in
{3}  esac
  [[ $word == -* ]] && words=$options
  COMPREPLY=($(compgen -W "$words" -- "$word"))
}}
complete -o default -F _{0} {0}
)",
      root.name, paths, offers, values);
}

std::string zsh_completion(const CommandText& root) {
  std::string text =
      fmt::format("#compdef {0}\n# SPDX-License-Identifier: Apache-2.0\n", root.name);
  for_each_command(root, [&](const CommandText& c) {
    std::string arguments;
    for (const OptionText& o : c.options) {
      const std::string description =
          replaced(replaced(replaced(replaced(first_line(o.description), "\\", "\\\\"), "[", "\\["),
                            "]", "\\]"),
                   ":", "\\:");
      const std::string rest =
          quoted("[" + description + "]" + (o.value.empty() ? "" : zsh_value(o)));
      // Every name of the option, each ruled out by the others.
      for (const std::string& name : o.names)
        arguments +=
            fmt::format(" \\\n    {}{}",
                        quoted(o.names.size() > 1 ? "(" + joined(o.names) + ")" : "") + name, rest);
    }
    if (c.commands.empty()) {
      for (const OptionText& o : c.positionals) arguments += " \\\n    " + quoted(zsh_value(o));
      arguments += " \\\n    '*:file:_files'";
      text += fmt::format("{}() {{\n  _arguments{}\n}}\n", zsh_function(c), arguments);
      return;
    }
    std::string list, cases;
    for (const CommandText& below : c.commands) {
      list += "\n        " +
              quoted(replaced(below.name, ":", "\\:") + ":" + first_line(below.description));
      cases += fmt::format("        {}) {} ;;\n", below.name, zsh_function(below));
    }
    text += fmt::format(
        R"({0}() {{
  local curcontext="$curcontext" state line
  local -a commands
  typeset -A opt_args
  _arguments -C{1} \
    '1: :->command' '*:: :->arguments'
  case $state in
    command)
      commands=({2})
      _describe command commands
      ;;
    arguments)
      case $words[1] in
{3}      esac
      ;;
  esac
}}
)",
        zsh_function(c), arguments, list, cases);
  });
  return text + fmt::format("{} \"$@\"\n", zsh_function(root));
}

std::string fish_completion(const CommandText& root) {
  std::string paths, lines;
  for_each_command(root, [&](const CommandText& c) {
    paths += " " + fish_quoted(c.path);
    const std::string at = fmt::format("complete -c {} -n {}", root.name,
                                       fish_quoted(fmt::format("__{}_at '{}'", root.name, c.path)));
    for (const CommandText& below : c.commands)
      lines += fmt::format("{} -f -a {} -d {}\n", at, below.name,
                           fish_quoted(first_line(below.description)));
    for (const OptionText& o : c.positionals)
      if (!o.choices.empty())
        lines += fmt::format("{} -f -a {}\n", at, fish_quoted(joined(o.choices)));
    for (const OptionText& o : c.options) {
      lines += at;
      for (const std::string& name : o.names)
        lines += name[1] == '-' ? " -l " + name.substr(2) : " -s " + name.substr(1);
      if (!o.choices.empty())
        lines += " -x -a " + fish_quoted(joined(o.choices));
      else if (!o.value.empty())
        lines += " -r";
      lines += fmt::format(" -d {}\n", fish_quoted(first_line(o.description)));
    }
  });
  return fmt::format(
      R"(# SPDX-License-Identifier: Apache-2.0
# Completion of {0} in fish.
set -g __{0}_commands{1}
function __{0}_at --description 'Whether the command line is at this command'
    set -l at {0}
    for word in (commandline -opc)[2..-1]
        if contains -- "$at $word" $__{0}_commands
            set at "$at $word"
        end
    end
    test "$at" = "$argv[1]"
end
{2})",
      root.name, paths, lines);
}

}  // namespace photonloom

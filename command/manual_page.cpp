// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <sstream>

#include "command/command_tree.hpp"

namespace photonloom {
namespace {

// Text as roff prints it, each line as it stands.
std::string roff(const std::string& text) {
  std::string out;
  bool line_begins = true;
  for (const char c : text) {
    if (line_begins && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if (c == '~')
      out += "\\(ti";
    else if (c == '^')
      out += "\\(ha";
    else if (c == '`')
      out += "\\(ga";
    else
      out += c;
    line_begins = c == '\n';
  }
  return out;
}

std::string as_it_stands(const std::string& text) {
  return text.empty() ? ""
                      : ".PP\n.nf\n" + roff(text) + (text.back() == '\n' ? "" : "\n") + ".fi\n";
}

std::string entry(const OptionText& option, bool positional) {
  std::string head;
  const char font = positional ? 'I' : 'B';
  for (const std::string& name : option.names)
    head += fmt::format("{}\\f{}{}\\fR", head.empty() ? "" : ", ", font, roff(name));
  std::string value = option.value;
  for (size_t i = 0; i < option.choices.size(); ++i)
    value = (i == 0 ? "" : value + "|") + option.choices[i];
  if (!value.empty() && (!positional || !option.choices.empty()))
    head += fmt::format(" \\fI{}\\fR", roff(value));
  if (!option.range.empty()) head += roff(" in " + option.range);
  return fmt::format(".TP\n{}\n{}\n", head, roff(option.description));
}

std::string synopsis(const CommandText& command) {
  std::string text = fmt::format("\\fB{}\\fR", roff(command.path));
  if (!command.options.empty()) text += " [\\fIOPTIONS\\fR]";
  for (const OptionText& p : command.positionals)
    text += fmt::format(" \\fI{}\\fR", roff(p.names[0]));
  if (!command.commands.empty()) text += " \\fICOMMAND\\fR ...";
  return text + "\n";
}

constexpr const char* kRest =
    R"(.SH FILES
.TP
\fI../share/photonloom\fR from the program's folder
RTL, boards, cell models, plans and scenes. \fBphotonloom \-\-data\-dir\fR prints its path.
.TP
\fI\(ti/.cache/photonloom\fR
Simulation models, built when first needed and kept under the hash of all that went into them. May be removed at any time.
.SH ENVIRONMENT
.TP
\fBXDG_CACHE_HOME\fR
Takes the place of \fI\(ti/.cache\fR.
.TP
\fBPHOTONLOOM_RTL\fR
Folder of the RTL sources, in place of that in \fBphotonloom \-\-data\-dir\fR.
.TP
\fBPHOTONLOOM_HLS\fR
The same of the HLS kernels.
.TP
\fBPHOTONLOOM_BOARDS\fR
The same of the boards.
.TP
\fBCXX\fR
C++ compiler for simulation models, in place of \fBc++\fR.
.SH EXIT STATUS
0: done, and what was checked holds. 1: an error, or what was checked does not hold. 2: a wrong command line.
130, 143: interrupted, with unfinished outputs removed.
)";

}  // namespace

std::string manual_page(const CommandText& root, const std::string& version) {
  std::string text = fmt::format(
      ".\\\" SPDX-License-Identifier: Apache-2.0\n"
      ".TH PHOTONLOOM 1 \"\" \"{}\" \"User Commands\"\n"
      ".SH NAME\nphotonloom \\- photon\\-mapping hardware for one scene, generated and proved\n"
      ".SH SYNOPSIS\n{}.SH DESCRIPTION\n{}\n",
      roff(version), synopsis(root), roff(root.description));
  for (const OptionText& o : root.options) text += entry(o, false);
  text += ".SH COMMANDS\n";
  for_each_command(root, [&](const CommandText& c) {
    if (&c == &root) return;
    text += fmt::format(".SS {}\n{}\n.PP\n{}", roff(c.path.substr(root.name.size() + 1)),
                        roff(c.description + "."), synopsis(c));
    for (const OptionText& o : c.positionals) text += entry(o, true);
    for (const OptionText& o : c.options)
      if (o.names.back() != "--help") text += entry(o, false);
    text += as_it_stands(c.footer);
  });
  return text + kRest;
}

}  // namespace photonloom

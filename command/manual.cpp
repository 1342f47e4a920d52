// SPDX-License-Identifier: Apache-2.0
// photonloom manual man|bash|zsh|fish
#include <fmt/core.h>

#include <cstdio>
#include <map>

#include "command/command.hpp"
#include "command/command_tree.hpp"
#include "golden/numeric/output_file.hpp"

namespace photonloom {
namespace {

struct ManualOptions {
  std::string kind, output;
};

void manual(const ManualOptions& o, const CLI::App& app) {
  const CommandText root = command_tree(app);
  const std::string text = o.kind == "man"    ? manual_page(root, PHOTONLOOM_VERSION)
                           : o.kind == "bash" ? bash_completion(root)
                           : o.kind == "zsh"  ? zsh_completion(root)
                                              : fish_completion(root);
  if (o.output.empty())
    fmt::print("{}", text);
  else
    write_file(o.output, text);
}

void add_manual(CLI::App& app) {
  auto o = std::make_shared<ManualOptions>();
  CLI::App* c = app.add_subcommand("manual", "This program's manual page, or a shell's completion");
  c->footer(
      "Written from the commands themselves; `make install` puts each where it is looked for.\n\n"
      "Examples:\n"
      "  photonloom manual man | man -l -\n"
      "  source <(photonloom manual bash)");
  c->add_option("KIND", o->kind, "What to write")
      ->required()
      ->check(CLI::IsMember({"man", "bash", "zsh", "fish"}));
  c->add_option("-o,--output", o->output, "File to write (default: standard output)")
      ->type_name("FILE");
  c->callback([o, &app] { manual(*o, app); });
}

const Command manual_command(100, add_manual);

}  // namespace
}  // namespace photonloom

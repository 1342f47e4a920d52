// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <fmt/core.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <memory>
#include <new>
#include <string>

#include "command/command.hpp"
#include "command/console.hpp"
#include "command/tell.hpp"
#include "rtl/generate/data_files.hpp"

namespace photonloom {

std::vector<std::pair<int, Command::Add>>& registered_commands() {
  static std::vector<std::pair<int, Command::Add>> commands;
  return commands;
}

Command::Command(int place, Add add) { registered_commands().emplace_back(place, add); }

void ThreadsOption::add_to(CLI::App& command) {
  command
      .add_option("--threads", given_,
                  "Threads to use (default: all of this machine's). Never changes a result.")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
}

void ThreadsOption::apply() const {
  static std::unique_ptr<tbb::global_control> limit;
  if (given_ > 0)
    limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                  static_cast<size_t>(given_));
}

int ThreadsOption::threads() const {
  return given_ > 0 ? given_ : tbb::info::default_concurrency();
}

void require_suffix(const std::string& option, const std::string& path, const std::string& suffix) {
  if (std::filesystem::path(path).extension() != suffix)
    throw UsageError(
        fmt::format("{}: '{}', expected a name that ends in {}", option, path, suffix));
}

namespace {

int run(int argc, char** argv) {
  CLI::App app{
      "Photonloom: photon-mapping hardware for one scene at one accuracy, generated and checked.\n"
      "Each command explains itself: photonloom COMMAND --help.",
      "photonloom"};
  app.require_subcommand(1);
  app.set_version_flag("--version", PHOTONLOOM_VERSION);
  const auto print_data_dir = [] {
    fmt::print("{}\n", data_dir());
    throw CLI::Success();
  };
  app.add_flag_callback("--data-dir", print_data_dir,
                        "Print the folder of the program's RTL, boards and scenes, and exit");
  std::sort(registered_commands().begin(), registered_commands().end());
  for (const auto& [place, add] : registered_commands()) add(app);
  check_values(app);
  const CLI::App* above = &app;
  std::string path = "photonloom";
  for (int i = 1; i < argc && above->get_require_subcommand_min() > 0; ++i) {
    const std::string word = argv[i];
    if (word.empty()) break;
    if (word[0] == '-') {
      const std::string option = word.substr(0, word.starts_with("--") ? word.find('=') : 2);
      if (above == &app && !app.get_option_no_throw(option))
        throw UsageError(
            fmt::format("{}: is no option of photonloom; photonloom --help lists them", word));
      break;
    }
    const auto found = above->get_subcommands(
        [&](const CLI::App* command) { return command->get_name() == word; });
    if (found.empty())
      throw UsageError(fmt::format("'{}' is no command{}; {} --help lists them", word,
                                   above == &app ? "" : " of " + above->get_name(), path));
    above = found.front();
    path += " " + word;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return 0;
}

// glibc maps a large block for itself and unmaps it when it is freed, and takes such blocks from
// its heap only after it has freed some. A frame takes and frees many, and the system would clear
// their pages each time: the thresholds are from the start those at which glibc's own end.
void keep_freed_blocks() {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 64 << 20);
#endif
}

// Files that are opened would take the places of standard streams that are closed, and what goes to
// these streams would end up in them. Reading and writing still fail.
void fill_closed_streams() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(descriptor, F_GETFD) < 0 && errno == EBADF)
      // The lowest that is free is the one that is taken.
      static_cast<void>(open("/dev/null", descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY));
}

}  // namespace
}  // namespace photonloom

int main(int argc, char** argv) {
  photonloom::fill_closed_streams();
  photonloom::keep_freed_blocks();
  photonloom::handle_interrupts();
  const auto output_lost = [](int reason) {
    if (reason == EPIPE) return 128 + SIGPIPE;  // who ended before has seen enough
    photonloom::tell("photonloom: standard output: cannot be written: {}\n", std::strerror(reason));
    return 1;
  };
  try {
    const int status = photonloom::run(argc, argv);
    // What a full disk or a closed stream swallowed shows here at the latest.
    if (std::fflush(stdout) != 0 || std::ferror(stdout)) return output_lost(errno);
    return status;
  } catch (const photonloom::UsageError& error) {
    photonloom::tell("photonloom: {}\n", error.what());
    return 2;
  } catch (const std::system_error& error) {
    if (std::ferror(stdout)) return output_lost(error.code().value());
    photonloom::tell("photonloom: {}\n", error.what());
    return 1;
  } catch (const std::bad_alloc&) {
    photonloom::tell("photonloom: not enough memory, expected fewer pixels or photons\n");
    return 1;
  } catch (const std::exception& error) {
    photonloom::tell("photonloom: {}\n", error.what());
    return 1;
  }
}

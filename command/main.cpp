// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <memory>
#include <new>
#include <string>
#include <system_error>

#include "command/command.hpp"
#include "command/console.hpp"
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

CLI::Validator number_range(double low, double high) {
  const auto within = [low, high](std::string& text) -> std::string {
    double value = 0;
    if (CLI::detail::lexical_cast(text, value) && value >= low && value <= high) return {};
    return fmt::format("'{}', expected a number from {} to {}", text, low, high);
  };
  return CLI::Validator(within, fmt::format("FLOAT in [{} - {}]", low, high));
}

CLI::Option* add_seed_option(CLI::App& command, uint64_t& seed, const std::string& description) {
  // CLI11 alone takes -1 for 2^64 - 1 and, in some versions, 010 for 8.
  const auto canonical = [](std::string& text) -> std::string {
    uint64_t value = 0;
    const char* end = text.data() + text.size();
    const auto read = std::from_chars(text.data(), end, value);
    if (read.ec != std::errc() || read.ptr != end)
      return fmt::format("'{}', expected an integer from 0 to 2^64 - 1", text);
    text = std::to_string(value);
    return {};
  };
  return command.add_option("--seed", seed, description)
      ->transform(CLI::Validator(canonical, "", "seed"))
      ->type_name("S");
}

namespace {

// What follows `mark` in the type that --help shows of the option: "[1 - 256]" of "N:UINT in [1 -
// 256]".
std::string range_text(const CLI::Option& option, const std::string& mark) {
  const std::string type = option.get_type_name();
  const size_t at = type.find(mark);
  if (at == std::string::npos) return {};
  const size_t first = at + mark.size();
  return type.substr(first, type.find(']', first) + 1 - first);
}

// The number as from_chars reads it, written canonically. CLI11 alone takes -1 for 2^64 - 1, what
// is beyond 64 bits for their largest number, and, in some versions, 010 for 8.
template <class Integer>
CLI::Validator canonical_integer(const std::string& range) {
  return CLI::Validator(
      [range](std::string& text) -> std::string {
        Integer value = 0;
        const char* end = text.data() + text.size();
        const auto read = std::from_chars(text.data(), end, value);
        if (read.ec != std::errc() || read.ptr != end)
          return fmt::format("'{}', expected an integer in {}", text, range);
        text = std::to_string(value);
        return {};
      },
      "", "integer");
}

// The checks that all options share, of `command` and of those below it.
void check_values(CLI::App& command) {
  // An empty value is a slip (of a shell variable, most often), never the same as no option.
  static const CLI::Validator not_empty(
      [](std::string& value) { return value.empty() ? "'', expected a value" : ""; }, "");
  for (CLI::Option* option : command.get_options()) {
    option->check(not_empty);
    if (const std::string natural = range_text(*option, "UINT in "); !natural.empty())
      option->transform(canonical_integer<uint64_t>(natural));
    else if (const std::string whole = range_text(*option, "INT in "); !whole.empty())
      option->transform(canonical_integer<int64_t>(whole));
  }
  for (CLI::App* below : command.get_subcommands([](const CLI::App*) { return true; }))
    check_values(*below);
}

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
  const std::string first = argc > 1 ? argv[1] : "";
  const auto named = [&first](const CLI::App* command) { return command->get_name() == first; };
  if (!first.empty() && first[0] != '-' && app.get_subcommands(named).empty())
    throw UsageError(fmt::format("'{}' is no command; photonloom --help lists them", first));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return 0;
}

}  // namespace
}  // namespace photonloom

int main(int argc, char** argv) {
  photonloom::handle_interrupts();
  const auto output_lost = [](int reason) {
    fmt::print(stderr, "photonloom: standard output: cannot be written: {}\n",
               std::strerror(reason));
    return 1;
  };
  try {
    const int status = photonloom::run(argc, argv);
    // What a full disk or a closed stream swallowed shows here at the latest.
    if (std::fflush(stdout) != 0 || std::ferror(stdout)) return output_lost(errno);
    return status;
  } catch (const photonloom::UsageError& error) {
    fmt::print(stderr, "photonloom: {}\n", error.what());
    return 2;
  } catch (const std::system_error& error) {
    if (std::ferror(stdout)) return output_lost(error.code().value());
    fmt::print(stderr, "photonloom: {}\n", error.what());
    return 1;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "photonloom: not enough memory\n");
    return 1;
  } catch (const std::exception& error) {
    fmt::print(stderr, "photonloom: {}\n", error.what());
    return 1;
  }
}

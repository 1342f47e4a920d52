// SPDX-License-Identifier: Apache-2.0
#include "verilator_tb/rig/number_options.hpp"

#include <fmt/core.h>

namespace photonloom {
namespace {

// The type that --help shows of the option, as far as `kind` of it goes: "UINT in [1 - 256]" of
// "N:UINT in [1 - 256]", "UINT" where it has no range, empty where it is of another kind.
std::string type_text(const CLI::Option& option, const std::string& kind) {
  const std::string type = option.get_type_name();
  if (const size_t range = type.find(kind + " in ["); range != std::string::npos)
    // "INT in [" is the end of "UINT in [" too.
    return range > 0 && type[range - 1] == 'U'
               ? ""
               : type.substr(range, type.find(']', range) + 1 - range);
  return type.starts_with(kind) ? kind : "";
}

// The number as strict_number() reads it, written canonically: some versions of CLI11 take 010
// for 8.
template <class Integer>
CLI::Validator canonical_integer(const std::string& expected, const std::string& name) {
  return CLI::Validator(
      [expected](std::string& text) -> std::string {
        const auto value = strict_number<Integer>(text);
        if (!value) return fmt::format("'{}', expected {}", text, expected);
        text = std::to_string(*value);
        return {};
      },
      "", name);
}

template <class Integer>
CLI::Validator integer_of(const std::string& type) {
  const size_t range = type.find('[');
  return canonical_integer<Integer>(
      range == std::string::npos ? "an integer" : "an integer in " + type.substr(range), "integer");
}

}  // namespace

CLI::Validator number_value(const std::string& expected, std::function<bool(double)> holds) {
  return CLI::Validator(
      [expected, holds = std::move(holds)](std::string& text) -> std::string {
        const auto value = strict_number<double>(text);
        if (value && (!holds || holds(*value))) return {};
        return fmt::format("'{}', expected {}", text, expected);
      },
      "");
}

CLI::Validator number_range(double low, double high) {
  CLI::Validator range =
      number_value(fmt::format("a number from {} to {}", low, high),
                   [low, high](double value) { return value >= low && value <= high; });
  range.description(fmt::format("FLOAT in [{} - {}]", low, high));
  return range;
}

CLI::Validator seed_number() {
  return canonical_integer<uint64_t>("an integer from 0 to 2^64 - 1", "seed");
}

void check_values(CLI::App& command) {
  // An empty value is a slip (of a shell variable, most often), never the same as no option.
  static const CLI::Validator not_empty(
      [](std::string& value) { return value.empty() ? "'', expected a value" : ""; }, "");
  for (CLI::Option* option : command.get_options()) {
    option->check(not_empty);
    if (const std::string natural = type_text(*option, "UINT"); !natural.empty())
      option->transform(integer_of<uint64_t>(natural));
    else if (const std::string whole = type_text(*option, "INT"); !whole.empty())
      option->transform(integer_of<int64_t>(whole));
    else if (type_text(*option, "FLOAT") == "FLOAT")
      option->transform(number_value("a number"));
  }
  for (CLI::App* below : command.get_subcommands([](const CLI::App*) { return true; }))
    check_values(*below);
}

}  // namespace photonloom

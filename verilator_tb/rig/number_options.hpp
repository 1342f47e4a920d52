// SPDX-License-Identifier: Apache-2.0
// Options of a command line whose values are numbers, read by strict_number() alone: CLI11 takes -1
// for 2^64 - 1, 1e-999 for 0, 0x10 for 16 and blanks for nothing.
#pragma once
#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>

#include "golden/numeric/strict_number.hpp"

namespace photonloom {

// A wrong command line: the error names the option and what was expected.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// A number for which `holds`; `expected` says which ones those are.
CLI::Validator number_value(const std::string& expected,
                            std::function<bool(double)> holds = nullptr);

// A number from `low` to `high`.
CLI::Validator number_range(double low, double high);

// An integer from 0 to 2^64 - 1.
CLI::Validator seed_number();

// --seed S, or another flag that takes a seed.
template <class Seed>
CLI::Option* add_seed_option(CLI::App& command, Seed& seed, const std::string& description,
                             const std::string& flag = "--seed") {
  return command.add_option(flag, seed, description)->transform(seed_number())->type_name("S");
}

// The checks that all options of `command` and of those below it share; to be called once they are
// all there. No value is empty. One whose type --help shows as INT, UINT or FLOAT is read strictly;
// an option that shows another name (type_name) and has no range needs one of the above.
void check_values(CLI::App& command);

}  // namespace photonloom

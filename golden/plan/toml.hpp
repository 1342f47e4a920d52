// SPDX-License-Identifier: Apache-2.0
// TOML files: plans, studies, boards.
#pragma once
#include <toml++/toml.h>

#include <string>
#include <string_view>

namespace photonloom {

// As toml::parse; toml::parse_error too where a character beyond ASCII stands outside of strings
// and comments (TOML 1.0 has none there, and for some of them, U+00A1 to U+0499 among others, what
// toml++ 3.3 does is undefined), where a dotted key has more than 64 parts (toml++ calls itself for
// each) and where a number other than 0 is too small for a double (toml++ takes it for 0).
toml::table parse_toml(std::string_view text, const std::string& file = "");

// The shortest text that reads back to the same double, always with a point or an exponent.
std::string toml_number(double x);

// A value as a message shows it; "a table" for a table. toml++ 3.3 measures numbers in arrays by
// their logarithm, which is undefined for 0.01.
std::string toml_text(const toml::node& node);

}  // namespace photonloom

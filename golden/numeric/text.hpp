// SPDX-License-Identifier: Apache-2.0
// Numbers and words in text files, read the same in every locale and rounded exactly.
#pragma once
#include <concepts>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace photonloom {

// A decimal number that fills the whole text ("1", "+.5", "1e-3"). Also accepts "nan" and "inf":
// whoever needs a finite number must say so. Nothing where the text is not a number or too large.
std::optional<double> parse_double(std::string_view text);

// A decimal integer that fills the whole text.
std::optional<int64_t> parse_integer(std::string_view text);

// Text between separators; no empty words.
std::vector<std::string_view> split(std::string_view text, std::string_view separators);
// The words would outlive their text.
template <std::same_as<std::string> Text>
std::vector<std::string_view> split(Text&& text, std::string_view separators) = delete;

// The beginning of a text from a file, as a message may show it: bytes that end a text or move the
// cursor as \x00.
std::string shown(std::string_view text);

// A field of a CSV file, in quotes where it holds what would end it.
std::string csv_field(const std::string& text);

// Seconds as a person says them: "0.4 s", "12 s", "3 min 20 s", "2 h 5 min".
std::string spoken(double seconds);

// A to Z as a to z, whatever the locale.
std::string lower(std::string text);

// Folder of a path with its final '/', "" for a bare file name.
std::string folder_of(const std::string& path);

}  // namespace photonloom

// SPDX-License-Identifier: Apache-2.0
#include "golden/scene/ply.hpp"

#include <fmt/core.h>

#include <bit>
#include <cmath>
#include <limits>

#include "golden/numeric/output_file.hpp"
#include "golden/numeric/text.hpp"
#include "golden/scene/scene.hpp"

namespace photonloom {
namespace {

struct TypeName {
  const char *name, *sized_name;
  PlyType type;
  size_t bytes;
  double lowest, highest;  // of the integer types
};
constexpr std::string_view kBlanks = " \t\r";  // within a line of an ASCII body
constexpr double kAny = std::numeric_limits<double>::infinity();
constexpr TypeName kTypes[] = {
    {"char", "int8", PlyType::kInt8, 1, -128, 127},
    {"uchar", "uint8", PlyType::kUint8, 1, 0, 255},
    {"short", "int16", PlyType::kInt16, 2, -32768, 32767},
    {"ushort", "uint16", PlyType::kUint16, 2, 0, 65535},
    {"int", "int32", PlyType::kInt32, 4, -2147483648.0, 2147483647.0},
    {"uint", "uint32", PlyType::kUint32, 4, 0, 4294967295.0},
    {"float", "float32", PlyType::kFloat, 4, -kAny, kAny},
    {"double", "float64", PlyType::kDouble, 8, -kAny, kAny},
};
const TypeName& info(PlyType type) { return kTypes[static_cast<size_t>(type)]; }
bool is_integer(PlyType type) { return type != PlyType::kFloat && type != PlyType::kDouble; }

// Reads the header line by line and the body value by value; keeps the place for messages.
class Reader {
 public:
  Reader(std::string_view bytes, const std::string& path) : bytes_(bytes), path_(path) {}

  PlyTable read() {
    header();
    for (PlyElement& element : table_.elements) body(element);
    end();
    return std::move(table_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    if (in_header_ || table_.format == PlyFormat::kAscii)
      throw SceneError(fmt::format("{}:{}: {}", path_, line_, what));
    throw SceneError(fmt::format("{}: byte {}: {}", path_, at_, what));
  }

  std::string_view next_line() {
    if (at_ >= bytes_.size()) fail("the file ends early");
    ++line_;
    size_t end = bytes_.find('\n', at_);
    if (end == std::string_view::npos) end = bytes_.size();
    std::string_view text = bytes_.substr(at_, end - at_);
    at_ = std::min(end + 1, bytes_.size());
    if (!text.empty() && text.back() == '\r') text.remove_suffix(1);
    return text;
  }

  PlyType type_of(std::string_view name) const {
    for (const TypeName& t : kTypes)
      if (name == t.name || name == t.sized_name) return t.type;
    fail(fmt::format(
        "property type '{}' is unknown, expected char, uchar, short, ushort, int, uint, float or "
        "double",
        name));
  }

  void header() {
    if (bytes_.substr(0, 3) != "ply" ||
        (bytes_.size() > 3 && bytes_[3] != '\n' && bytes_[3] != '\r'))
      throw SceneError(
          fmt::format("{}:1: not a PLY file, expected 'ply' as the first line", path_));
    next_line();
    bool has_format = false;
    for (;;) {
      const std::string_view text = next_line();
      const auto words = split(text, " \t");
      if (words.empty()) continue;
      if (words[0] == "end_header") break;
      if (words[0] == "comment" || words[0] == "obj_info") {
        if (words[0] == "comment")
          table_.comments.emplace_back(text.size() > 8 ? text.substr(8) : std::string_view());
      } else if (words[0] == "format") {
        if (words.size() != 3 || words[2] != "1.0" || has_format)
          fail("expected one line 'format TYPE 1.0'");
        if (words[1] == "ascii") {
          table_.format = PlyFormat::kAscii;
        } else if (words[1] == "binary_little_endian") {
          table_.format = PlyFormat::kLittleEndian;
        } else if (words[1] == "binary_big_endian") {
          table_.format = PlyFormat::kBigEndian;
        } else {
          fail(fmt::format(
              "format '{}' is unknown, expected ascii, binary_little_endian or binary_big_endian",
              words[1]));
        }
        has_format = true;
      } else if (words[0] == "element") {
        const auto rows =
            words.size() == 3 ? parse_integer(words[2]) : std::optional<int64_t>(std::nullopt);
        if (!rows || *rows < 0) fail("expected 'element NAME COUNT' with a count of at least 0");
        if (table_.find(words[1])) fail(fmt::format("element '{}' is given twice", words[1]));
        table_.elements.emplace_back();
        table_.elements.back().name = std::string(words[1]);
        table_.elements.back().rows = static_cast<uint64_t>(*rows);
      } else if (words[0] == "property") {
        if (table_.elements.empty()) fail("property before the first element");
        PlyElement& element = table_.elements.back();
        PlyColumn column;
        if (words.size() == 5 && words[1] == "list") {
          column.is_list = true;
          column.size_type = type_of(words[2]);
          if (!is_integer(column.size_type)) fail("a list's length must have an integer type");
          column.type = type_of(words[3]);
          column.name = std::string(words[4]);
        } else if (words.size() == 3) {
          column.type = type_of(words[1]);
          column.name = std::string(words[2]);
        } else {
          fail("expected 'property TYPE NAME' or 'property list TYPE TYPE NAME'");
        }
        if (element.find(column.name))
          fail(fmt::format("property '{}' is given twice in element '{}'", column.name,
                           element.name));
        element.columns.push_back(std::move(column));
      } else {
        fail(fmt::format("'{}' is unknown in a PLY header", words[0]));
      }
    }
    if (!has_format) fail("the header has no format line");
    in_header_ = false;
    ++line_;  // that of the body's first value
  }

  // Bytes a row takes at least; what is left of the file bounds how many rows there can be.
  uint64_t least_bytes(const PlyElement& element) const {
    uint64_t bytes = 0;
    for (const PlyColumn& c : element.columns)
      bytes +=
          table_.format == PlyFormat::kAscii ? 1 : info(c.is_list ? c.size_type : c.type).bytes;
    return bytes;
  }

  void body(PlyElement& element) {
    if (element.columns.empty()) return;
    // In ASCII a value is at least one character with one blank after it, except at the very end.
    const uint64_t spare = table_.format == PlyFormat::kAscii ? 1 : 0;
    const uint64_t least = least_bytes(element) * (1 + spare);
    if (element.rows > (bytes_.size() - at_ + spare) / least)
      fail(
          fmt::format("the file ends early: element '{}' has {} rows of at least {} bytes, but {} "
                      "bytes are left",
                      element.name, element.rows, least, bytes_.size() - at_));
    for (PlyColumn& c : element.columns) {
      if (c.is_list) {
        c.starts.reserve(element.rows + 1);
        c.starts.push_back(0);
      } else {
        c.values.reserve(element.rows);
      }
    }
    for (uint64_t row = 0; row < element.rows; ++row) {
      if (row > 0) end_line(element);
      skip_empty_lines();
      for (PlyColumn& c : element.columns) {
        if (!c.is_list) {
          c.values.push_back(value(c.type, element, c));
          continue;
        }
        const double length = value(c.size_type, element, c);
        if (length < 0 || length > static_cast<double>(bytes_.size() - at_))
          fail(fmt::format("a list of {} entries in property '{}' does not fit in the file", length,
                           c.name));
        for (double i = 0; i < length; ++i) c.values.push_back(value(c.type, element, c));
        c.starts.push_back(c.values.size());
      }
    }
    if (element.rows > 0) end_line(element);
  }

  // A count in the header that is too small would lose rows without a word.
  void end() {
    skip_empty_lines();
    if (at_ < bytes_.size())
      fail(fmt::format("expected the file's end after the last element's last row; bytes left: {}",
                       bytes_.size() - at_));
  }

  void skip_blanks() { at_ = std::min(bytes_.find_first_not_of(kBlanks, at_), bytes_.size()); }

  bool at_line_end() const { return at_ < bytes_.size() && bytes_[at_] == '\n'; }

  void skip_empty_lines() {
    if (table_.format != PlyFormat::kAscii) return;
    for (skip_blanks(); at_line_end(); skip_blanks()) {
      ++at_;
      ++line_;
    }
  }

  std::string_view word() const {
    return bytes_.substr(at_, bytes_.find_first_of(" \t\r\n", at_) - at_);
  }

  // A row is a line: a value too many or too few would else move all that follow.
  void end_line(const PlyElement& element) {
    if (table_.format != PlyFormat::kAscii) return;
    skip_blanks();
    if (at_ < bytes_.size() && !at_line_end())
      fail(
          fmt::format("expected the line's end after the last value of a row of element '{}', not "
                      "'{}'",
                      element.name, shown(word())));
  }

  double value(PlyType type, const PlyElement& element, const PlyColumn& column) {
    return table_.format == PlyFormat::kAscii ? ascii(type, element, column)
                                              : binary(type, element, column);
  }

  double ascii(PlyType type, const PlyElement& element, const PlyColumn& column) {
    skip_blanks();
    if (at_ >= bytes_.size())
      fail(fmt::format("the file ends early, in property '{}' of element '{}'", column.name,
                       element.name));
    if (at_line_end())
      fail(fmt::format("the line ends early, before property '{}', expected a whole row of '{}'",
                       column.name, element.name));
    const std::string_view text = word();
    at_ += text.size();
    const auto number = parse_double(text);
    const TypeName& t = info(type);
    if (!number || (is_integer(type) && (!(*number >= t.lowest && *number <= t.highest) ||
                                         *number != std::floor(*number))))
      fail(fmt::format("'{}' in property '{}' of element '{}' is not a {}", shown(text),
                       column.name, element.name, t.name));
    return type == PlyType::kFloat ? static_cast<double>(static_cast<float>(*number)) : *number;
  }

  double binary(PlyType type, const PlyElement& element, const PlyColumn& column) {
    const size_t n = info(type).bytes;
    if (bytes_.size() - at_ < n)
      fail(fmt::format("the file ends early, in property '{}' of element '{}'", column.name,
                       element.name));
    uint64_t word = 0;
    for (size_t i = 0; i < n; ++i) {
      const uint64_t byte = static_cast<unsigned char>(bytes_[at_ + i]);
      word |= byte << (8 * (table_.format == PlyFormat::kLittleEndian ? i : n - 1 - i));
    }
    at_ += n;
    switch (type) {
      case PlyType::kInt8:
        return static_cast<int8_t>(word);
      case PlyType::kInt16:
        return static_cast<int16_t>(word);
      case PlyType::kInt32:
        return static_cast<int32_t>(word);
      case PlyType::kFloat:
        return static_cast<double>(std::bit_cast<float>(static_cast<uint32_t>(word)));
      case PlyType::kDouble:
        return std::bit_cast<double>(word);
      default:
        return static_cast<double>(word);
    }
  }

  std::string_view bytes_;
  const std::string& path_;
  size_t at_ = 0;
  uint64_t line_ = 0;
  bool in_header_ = true;
  PlyTable table_;
};

void append_value(std::string& out, double value, PlyType type, PlyFormat format,
                  const PlyColumn& column, const std::string& path) {
  const TypeName& t = info(type);
  if (is_integer(type) &&
      (!(value >= t.lowest && value <= t.highest) || value != std::floor(value)))
    throw SceneError(fmt::format("{}: {} in property '{}' does not fit in a {}", path, value,
                                 column.name, t.name));
  if (format == PlyFormat::kAscii) {
    // The shortest decimal that reads back as the same number.
    out += type == PlyType::kFloat ? fmt::format("{} ", static_cast<float>(value))
                                   : fmt::format("{} ", value);
    return;
  }
  uint64_t word = 0;
  if (type == PlyType::kFloat) {
    word = std::bit_cast<uint32_t>(static_cast<float>(value));
  } else if (type == PlyType::kDouble) {
    word = std::bit_cast<uint64_t>(value);
  } else {
    word = static_cast<uint64_t>(static_cast<int64_t>(value));
  }
  for (size_t i = 0; i < t.bytes; ++i)
    out +=
        static_cast<char>(word >> (8 * (format == PlyFormat::kLittleEndian ? i : t.bytes - 1 - i)));
}

}  // namespace

const PlyColumn* PlyElement::find(std::string_view column) const {
  for (const PlyColumn& c : columns)
    if (c.name == column) return &c;
  return nullptr;
}

const std::vector<double>& PlyElement::scalar(std::string_view column,
                                              const std::string& path) const {
  const PlyColumn* c = find(column);
  if (!c || c->is_list)
    throw SceneError(
        fmt::format("{}: element '{}' has no property '{}', expected one number of that name per "
                    "row",
                    path, name, column));
  return c->values;
}

PlyColumn& PlyElement::add(const std::string& column, PlyType type) {
  columns.emplace_back();
  columns.back().name = column;
  columns.back().type = type;
  return columns.back();
}

const PlyElement* PlyTable::find(std::string_view element) const {
  for (const PlyElement& e : elements)
    if (e.name == element) return &e;
  return nullptr;
}

PlyTable parse_ply(std::string_view bytes, const std::string& path) {
  return Reader(bytes, path).read();
}

PlyTable read_ply(const std::string& path) { return parse_ply(read_file(path), path); }

void write_ply(const PlyTable& table, const std::string& path) {
  std::string out = "ply\nformat ";
  out += table.format == PlyFormat::kAscii          ? "ascii"
         : table.format == PlyFormat::kLittleEndian ? "binary_little_endian"
                                                    : "binary_big_endian";
  out += " 1.0\n";
  for (const std::string& comment : table.comments) out += "comment " + comment + "\n";
  for (const PlyElement& element : table.elements) {
    out += fmt::format("element {} {}\n", element.name, element.rows);
    for (const PlyColumn& c : element.columns) {
      if (c.is_list ? c.starts.size() != element.rows + 1 : c.values.size() != element.rows)
        throw std::logic_error("write_ply: a column's length is not its element's");
      out += c.is_list ? fmt::format("property list {} {} {}\n", info(c.size_type).name,
                                     info(c.type).name, c.name)
                       : fmt::format("property {} {}\n", info(c.type).name, c.name);
    }
  }
  out += "end_header\n";

  OutputFile file(path);
  for (const PlyElement& element : table.elements) {
    for (uint64_t row = 0; row < element.rows && !element.columns.empty(); ++row) {
      for (const PlyColumn& c : element.columns) {
        if (!c.is_list) {
          append_value(out, c.values[row], c.type, table.format, c, path);
          continue;
        }
        append_value(out, static_cast<double>(c.starts[row + 1] - c.starts[row]), c.size_type,
                     table.format, c, path);
        for (uint64_t i = c.starts[row]; i < c.starts[row + 1]; ++i)
          append_value(out, c.values[i], c.type, table.format, c, path);
      }
      if (table.format == PlyFormat::kAscii) out.back() = '\n';
      file.write(out);
      out.clear();
    }
  }
  file.write(out);
  file.commit();
}

}  // namespace photonloom

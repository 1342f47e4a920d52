// SPDX-License-Identifier: Apache-2.0
// PLY files as tables: elements with typed properties as columns, and comments. ASCII and binary of
// both byte orders (Greg Turk, "The PLY Polygon File Format", 1994). Meshes and photon files are
// both read and written through this.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace photonloom {

enum class PlyFormat { kAscii, kLittleEndian, kBigEndian };
enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

// One property of every row. A double holds every PLY value exactly.
struct PlyColumn {
  std::string name;
  PlyType type = PlyType::kFloat;
  bool is_list = false;
  PlyType size_type = PlyType::kUint8;  // of a list's length
  std::vector<double> values;           // lists: all rows' entries one after another
  std::vector<uint64_t> starts;  // lists: where each row's entries begin, and the end: rows + 1
};

struct PlyElement {
  std::string name;  // "vertex", "face", ...
  uint64_t rows = 0;
  std::vector<PlyColumn> columns;
  const PlyColumn* find(std::string_view column) const;
  // The column, which must exist and not be a list; throws SceneError naming `path` otherwise.
  const std::vector<double>& scalar(std::string_view column, const std::string& path) const;
  PlyColumn& add(const std::string& column, PlyType type);
};

struct PlyTable {
  PlyFormat format = PlyFormat::kLittleEndian;
  std::vector<std::string> comments;  // without the word "comment"
  std::vector<PlyElement> elements;
  const PlyElement* find(std::string_view element) const;
};

// Both throw SceneError with file, line or byte, and what was expected. Values are as in the file:
// NaN and infinity pass. A count larger than the file can hold is an error before anything is
// reserved.
PlyTable read_ply(const std::string& path);
PlyTable parse_ply(std::string_view bytes, const std::string& path);

// The file appears whole or not at all. Values that their type cannot hold are an error.
void write_ply(const PlyTable& table, const std::string& path);

}  // namespace photonloom

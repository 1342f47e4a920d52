// SPDX-License-Identifier: Apache-2.0
// Scene files as trees of elements: includes spliced in, $parameters replaced, identifiers indexed,
// each element with its file and line. What elements mean is load_scene's business.
#pragma once
#include <deque>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "golden/scene/scene.hpp"

namespace photonloom {

struct Element {
  std::string tag;
  std::vector<std::pair<std::string, std::string>> attributes;  // after replacement
  std::vector<std::unique_ptr<Element>> children;
  const std::string* file = nullptr;
  size_t line = 0;

  const std::string* find(std::string_view attribute) const;
  // The attribute, "" where it is missing.
  const std::string& operator[](std::string_view attribute) const;
};

// Throws SceneError "FILE:LINE: what".
[[noreturn]] void fail(const Element& element, const std::string& what);

// "<bsdf type="phong" id="wall">", for messages.
std::string describe(const Element& element);

struct Document {
  std::unique_ptr<Element> root;        // <scene>
  std::map<std::string, Element*> ids;  // aliases included
  std::vector<std::string> folders;     // where files are looked for, the scene file's first
  bool new_dialect = false;             // 2.x and 3.x files, against 0.5 and 0.6
  std::deque<std::string> files;        // paths as given, for messages

  // `element` itself, or what it refers to where it is a <ref>.
  const Element& resolve(const Element& element) const;
  // An existing file for a name in `element`; throws SceneError naming it otherwise.
  std::string find_file(const Element& element, const std::string& name) const;
  mutable std::set<std::string> found;  // by it
};

// Reads `path` and what it includes. Refuses what is not XML, elements nested more than 64 deep,
// include and reference cycles, duplicate identifiers, references to nothing, undefined $names and
// parameters that the file does not use.
Document read_document(const std::string& path, const Parameters& parameters);

}  // namespace photonloom

// SPDX-License-Identifier: Apache-2.0
#include "golden/scene/xml.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <pugixml.hpp>
#include <set>

#include "golden/numeric/output_file.hpp"
#include "golden/numeric/text.hpp"
#include "golden/scene/upgrade.hpp"

namespace photonloom {
namespace {

// Far beyond any sensible file, and small enough that recursion over elements is safe.
constexpr int kMaxDepth = 64;
constexpr size_t kMaxElements = 1000000;
constexpr size_t kMaxAttribute = 1 << 16;

// One XML file while it is read.
struct File {
  const std::string* path;
  std::vector<size_t> lines;  // where each line begins
  pugi::xml_document xml;

  size_t line_of(ptrdiff_t offset) const {
    return static_cast<size_t>(
        std::upper_bound(lines.begin(), lines.end(),
                         static_cast<size_t>(std::max<ptrdiff_t>(offset, 0))) -
        lines.begin());
  }
};

class Builder {
 public:
  explicit Builder(const Parameters& parameters) {
    for (const auto& [name, value] : parameters) {
      if (!parameters_.emplace(name, Parameter{value, false, true}).second)
        throw SceneError(fmt::format("parameter '{}' is given twice with -D", name));
    }
  }

  Document build(const std::string& path) {
    document_.folders.push_back(folder_of(path));
    document_.root = std::make_unique<Element>();
    add_file(path, *document_.root, nullptr, 0);
    for (const auto& [name, parameter] : parameters_)
      if (parameter.given && !parameter.used)
        throw SceneError(fmt::format("{}: parameter '{}' given with -D is not used, expected {}",
                                     path, name, known_parameters()));
    upgrade(*document_.root, minor_);
    index(*document_.root);
    for (const auto& alias : aliases_) add_alias(*alias);
    check_references();
    return std::move(document_);
  }

 private:
  struct Parameter {
    std::string value;
    bool used = false;
    bool given = false;  // by -D, which wins over <default>
  };

  std::string known_parameters() const {
    std::string names;
    for (const auto& [name, parameter] : parameters_)
      if (parameter.used) names += (names.empty() ? "one of " : ", ") + name;
    return names.empty() ? "none: the file has no parameters" : names;
  }

  // Reads a file into `root` (the scene file) or its children into `root` (an included one).
  void add_file(const std::string& path, Element& root, const Element* include, int depth) {
    std::error_code error;
    const std::string canonical = std::filesystem::weakly_canonical(path, error).string();
    if (std::find(open_.begin(), open_.end(), canonical) != open_.end())
      fail(*include, fmt::format("cyclic include of '{}'", path));
    open_.push_back(canonical);

    document_.files.push_back(path);
    File file;
    file.path = &document_.files.back();
    const std::string text = read_file(path);
    file.lines.push_back(0);
    for (size_t i = 0; i < text.size(); ++i)
      if (text[i] == '\n') file.lines.push_back(i + 1);
    // pugixml passes over text outside the top element and stops at a zero byte.
    const size_t first =
        text.find_first_not_of(" \t\r\n", text.starts_with("\xEF\xBB\xBF") ? 3 : 0);
    if (first == std::string::npos || text[first] != '<' || text.find('\0') != std::string::npos)
      throw SceneError(fmt::format("{}:1: not an XML file, expected <scene>", path));
    if (text[text.find_last_not_of(" \t\r\n")] != '>')
      throw SceneError(fmt::format("{}:{}: not well-formed XML: the file does not end with a tag",
                                   path, file.lines.size()));
    const pugi::xml_parse_result result = file.xml.load_buffer(
        text.data(), text.size(),
        pugi::parse_cdata | pugi::parse_escapes | pugi::parse_wconv_attribute | pugi::parse_eol,
        pugi::encoding_utf8);
    if (!result)
      throw SceneError(fmt::format("{}:{}: not well-formed XML: {}", path,
                                   file.line_of(result.offset), parse_message(result)));
    check_depth(file);
    const pugi::xml_node top = file.xml.document_element();
    for (pugi::xml_node node = file.xml.first_child(); node; node = node.next_sibling())
      if (node.type() == pugi::node_element && node != top)
        throw SceneError(fmt::format("{}:{}: second top-level element <{}>, expected one <scene>",
                                     path, file.line_of(node.offset_debug()), node.name()));
    if (std::strcmp(top.name(), "scene") != 0)
      throw SceneError(fmt::format("{}:{}: the top element is <{}>, expected <scene>", path,
                                   file.line_of(top.offset_debug()),
                                   std::string(top.name()).substr(0, 40)));
    copy(file, top, root, include != nullptr, depth);
    open_.pop_back();
  }

  static std::string parse_message(const pugi::xml_parse_result& result) {
    switch (result.status) {
      case pugi::status_no_document_element:
        return "there is no element, expected <scene>";
      case pugi::status_end_element_mismatch:
        return "the file ends, or an end tag comes, before an element is closed";
      default:
        return result.description();
    }
  }

  // Without recursion: the file may be nested as deep as it is long.
  static void check_depth(const File& file) {
    int depth = 0;
    for (pugi::xml_node node = file.xml.document_element(); node;) {
      if (node.first_child()) {
        if (++depth > kMaxDepth)
          throw SceneError(fmt::format("{}:{}: elements are nested more than {} deep", *file.path,
                                       file.line_of(node.offset_debug()), kMaxDepth));
        node = node.first_child();
        continue;
      }
      while (node && !node.next_sibling()) {
        node = node.parent();
        --depth;
      }
      if (node) node = node.next_sibling();
    }
  }

  void copy(File& file, const pugi::xml_node& node, Element& out, bool included, int depth) {
    if (depth > kMaxDepth)
      fail(out, fmt::format("elements are nested more than {} deep", kMaxDepth));
    if (++elements_ > kMaxElements)
      throw SceneError(fmt::format("{}: more than {} elements", *file.path, kMaxElements));
    Element* target = &out;
    Element place;  // of an included <scene>, whose children go to the including one
    if (included) target = &place;
    target->tag = node.name();
    target->file = file.path;
    target->line = file.line_of(node.offset_debug());
    for (const pugi::xml_attribute attribute : node.attributes()) {
      if (target->find(attribute.name()))
        fail(*target,
             fmt::format("attribute '{}' of <{}> is given twice", attribute.name(), target->tag));
      target->attributes.emplace_back(attribute.name(), replace(*target, attribute.value()));
    }
    if (target->tag == "scene") check_version(*target, included);
    for (const pugi::xml_node child : node.children()) {
      if (child.type() == pugi::node_pcdata || child.type() == pugi::node_cdata) {
        const std::string_view text = child.value();
        const size_t at = text.find_first_not_of(" \t\r\n");
        if (at != std::string_view::npos)
          throw SceneError(
              fmt::format("{}:{}: text '{}' between elements", *file.path,
                          file.line_of(child.offset_debug() + static_cast<ptrdiff_t>(at)),
                          std::string(text.substr(at, 20))));
        continue;
      }
      if (child.type() != pugi::node_element) continue;
      auto element = std::make_unique<Element>();
      copy(file, child, *element, false, depth + 1);
      const bool top = node.parent().type() == pugi::node_document;
      if (element->tag == "default") {
        if (!top) fail(*element, "<default> is allowed at the top level only");
        take_default(*element);
      } else if (element->tag == "include") {
        if (!top) fail(*element, "<include> is allowed at the top level only");
        only_attributes(*element, {"filename"});
        add_file(document_.find_file(*element, (*element)["filename"]), out, element.get(),
                 depth + 1);
      } else if (element->tag == "alias") {
        if (!top) fail(*element, "<alias> is allowed at the top level only");
        only_attributes(*element, {"id", "as"});
        aliases_.push_back(std::move(element));
      } else if (element->tag == "path") {
        if (!top) fail(*element, "<path> is allowed at the top level only");
        only_attributes(*element, {"value"});
        std::string folder = (*element)["value"];
        if (folder.empty()) fail(*element, "<path> needs a value");
        if (folder.back() != '/') folder += '/';
        document_.folders.push_back(folder[0] == '/' ? folder : document_.folders.front() + folder);
      } else {
        out.children.push_back(std::move(element));
      }
    }
  }

  static void only_attributes(const Element& element, std::initializer_list<const char*> names) {
    for (const char* name : names)
      if (!element.find(name))
        fail(element, fmt::format("<{}> has no attribute '{}'", element.tag, name));
    for (const auto& [name, value] : element.attributes)
      if (std::find_if(names.begin(), names.end(),
                       [name = name](const char* n) { return n == name; }) == names.end())
        fail(element, fmt::format("attribute '{}' of <{}> is not supported", name, element.tag));
    for (const auto& child : element.children)
      fail(*child, fmt::format("<{}> is not allowed in <{}>", child->tag, element.tag));
  }

  void check_version(const Element& scene, bool included) {
    const std::string* version = scene.find("version");
    if (!version) {
      if (included) return;
      fail(scene, "<scene> has no version, expected version=\"0.6.0\" or \"3.0.0\", say");
    }
    std::vector<int64_t> numbers;
    for (const std::string_view word : split(*version, "."))
      numbers.push_back(parse_integer(word).value_or(-1));
    const bool written_so = version->find_first_not_of("0123456789.") == std::string::npos &&
                            std::count(version->begin(), version->end(), '.') + 1 ==
                                static_cast<std::ptrdiff_t>(numbers.size());
    const int64_t major = numbers.empty() ? -1 : numbers[0];
    const int64_t minor = numbers.size() < 2 ? 0 : numbers[1];
    const bool old = major == 0 && minor >= 3 && minor <= 6;
    if (!written_so || (!old && major != 2 && major != 3))
      fail(scene,
           fmt::format("version '{}' is not supported, expected 0.3 to 0.6, 2.x or 3.x", *version));
    if (included) {
      if (document_.new_dialect == old)
        fail(scene, fmt::format("version '{}' has other rules than the scene that includes this "
                                "file, expected {}",
                                *version, old ? "2.x or 3.x" : "0.3 to 0.6"));
      return;
    }
    document_.new_dialect = !old;
    if (old) minor_ = minor;
  }

  void take_default(const Element& element) {
    only_attributes(element, {"name", "value"});
    const std::string& name = element["name"];
    if (name.empty()) fail(element, "<default> has an empty name");
    const auto [at, inserted] = parameters_.emplace(name, Parameter{element["value"], true, false});
    at->second.used = true;
    if (!inserted && !at->second.given) at->second.value = element["value"];
  }

  // The longest parameter name after each '$' is replaced.
  std::string replace(const Element& element, const std::string& text) {
    std::string out;
    for (size_t i = 0; i < text.size();) {
      if (text[i] != '$') {
        out += text[i++];
        continue;
      }
      Parameter* best = nullptr;
      size_t length = 0;
      for (auto& [name, parameter] : parameters_) {
        if (name.size() > length && text.compare(i + 1, name.size(), name) == 0) {
          best = &parameter;
          length = name.size();
        }
      }
      if (!best) {
        size_t end = i + 1;
        while (end < text.size() &&
               (std::isalnum(static_cast<unsigned char>(text[end])) || text[end] == '_'))
          ++end;
        if (end == i + 1) fail(element, "'$' stands before no name of a parameter");
        fail(element,
             fmt::format("parameter '{}' is not defined, expected a <default> before it or "
                         "-D {}=VALUE",
                         text.substr(i, end - i), text.substr(i + 1, end - i - 1)));
      }
      best->used = true;
      out += best->value;
      i += 1 + length;
      if (out.size() > kMaxAttribute) fail(element, "an attribute is longer than 65536 characters");
    }
    return out;
  }

  void index(Element& element) {
    if (const std::string* id = element.find("id"); id && element.tag != "ref") {
      if (id->empty()) fail(element, fmt::format("<{}> has an empty id", element.tag));
      const auto [at, inserted] = document_.ids.emplace(*id, &element);
      if (!inserted)
        fail(element, fmt::format("id '{}' is used twice, first in line {} of {}", *id,
                                  at->second->line, *at->second->file));
    }
    for (const auto& child : element.children) index(*child);
  }

  void add_alias(const Element& alias) {
    const auto target = document_.ids.find(alias["id"]);
    if (target == document_.ids.end())
      fail(alias, fmt::format("<alias> of '{}', which no element has as its id", alias["id"]));
    if (!document_.ids.emplace(alias["as"], target->second).second)
      fail(alias, fmt::format("id '{}' is used twice", alias["as"]));
  }

  // Depth-first over elements that contain references; a path that returns to itself is a cycle.
  void check_references() {
    std::set<const Element*> done;
    std::vector<const Element*> path;
    visit(*document_.root, done, path, 0);
  }

  void visit(const Element& element, std::set<const Element*>& done,
             std::vector<const Element*>& path, int depth) {
    for (const auto& child : element.children) {
      if (child->tag != "ref") {
        if (done.count(child.get())) continue;
        path.push_back(child.get());
        visit(*child, done, path, depth);
        path.pop_back();
        continue;
      }
      const Element& target = document_.resolve(*child);
      if (done.count(&target)) continue;
      if (std::find(path.begin(), path.end(), &target) != path.end())
        fail(*child, fmt::format("cyclic reference: '{}' contains itself", (*child)["id"]));
      if (depth >= kMaxDepth)
        fail(*child, fmt::format("references are chained more than {} deep", kMaxDepth));
      path.push_back(&target);
      visit(target, done, path, depth + 1);
      path.pop_back();
    }
    done.insert(&element);
  }

  Document document_;
  std::map<std::string, Parameter> parameters_;
  std::vector<std::string> open_;  // files being read, outermost first
  std::vector<std::unique_ptr<Element>> aliases_;
  size_t elements_ = 0;
  int64_t minor_ = 6;  // of a 0.x file
};

}  // namespace

const std::string* Element::find(std::string_view attribute) const {
  for (const auto& [name, value] : attributes)
    if (name == attribute) return &value;
  return nullptr;
}

const std::string& Element::operator[](std::string_view attribute) const {
  static const std::string none;
  const std::string* value = find(attribute);
  return value ? *value : none;
}

void fail(const Element& element, const std::string& what) {
  throw SceneError(fmt::format("{}:{}: {}", *element.file, element.line, what));
}

std::string describe(const Element& element) {
  std::string out = "<" + element.tag;
  for (const char* key : {"type", "name", "id"})
    if (const std::string* value = element.find(key)) out += fmt::format(" {}=\"{}\"", key, *value);
  return out + ">";
}

const Element& Document::resolve(const Element& element) const {
  if (element.tag != "ref") return element;
  const std::string* id = element.find("id");
  if (!id) photonloom::fail(element, "<ref> has no id");
  const auto at = ids.find(*id);
  if (at == ids.end())
    photonloom::fail(element, fmt::format("<ref> to '{}', which no element has as its id", *id));
  return *at->second;
}

std::string Document::find_file(const Element& element, const std::string& name) const {
  if (name.empty()) photonloom::fail(element, fmt::format("{} names no file", describe(element)));
  std::vector<std::string> tries;
  if (name[0] == '/') {
    tries.push_back(name);
  } else {
    for (const std::string& folder : folders) tries.push_back(folder + name);
    tries.push_back(folder_of(*element.file) + name);
  }
  std::error_code ignored;
  for (const std::string& path : tries)
    if (std::filesystem::is_regular_file(path, ignored)) return *found.insert(path).first;
  for (const std::string& path : tries)
    if (std::filesystem::exists(path, ignored))
      photonloom::fail(
          element, fmt::format("'{}' is {}, expected a file", path,
                               std::filesystem::is_directory(path, ignored) ? "a folder"
                                                                            : "no regular file"));
  photonloom::fail(element, fmt::format("file '{}' does not exist", tries.front()));
}

Document read_document(const std::string& path, const Parameters& parameters) {
  return Builder(parameters).build(path);
}

}  // namespace photonloom

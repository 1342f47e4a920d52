// SPDX-License-Identifier: Apache-2.0
// The properties of one object of a scene file (<float>, <rgb>, <transform>, ...), typed and
// counted: what nobody asked for is an error, so nothing is dropped silently.
#pragma once
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "golden/scene/findings.hpp"
#include "golden/scene/spectrum.hpp"
#include "golden/scene/xml.hpp"

namespace photonloom {

// Property names are compared in the 3.x spelling; 0.x names ("toWorld", "intIOR") are the same
// words joined by capitals.
std::string canonical_name(const std::string& name);

class Properties {
 public:
  // Collects the property children of `object`; two of one name are an error.
  Properties(const Document& document, const Element& object);

  const Element& object() const { return object_; }
  const Document& document() const { return document_; }
  const std::string& type() const { return type_; }  // lower case

  bool has(const std::string& name) const { return find(name) != nullptr; }
  // The element of a property, for messages; the object itself where it is not given.
  const Element& element(const std::string& name) const;

  // Each marks the property as used and throws SceneError where it has another type or does not
  // parse. Numbers are finite.
  double number(const std::string& name, double otherwise);
  int64_t integer(const std::string& name, int64_t otherwise);
  bool boolean(const std::string& name, bool otherwise);
  std::string text(const std::string& name, const std::string& otherwise);
  Vec3 vector(const std::string& name, const Vec3& otherwise);
  // Components >= 0; `of` tells what a spectrum becomes.
  Rgb color(const std::string& name, const Rgb& otherwise, SpectrumOf of = SpectrumOf::kSurface);
  Mat4 transform(const std::string& name);                // identity where not given
  bool is_text(const std::string& name) const;            // given as <string>
  void ignore(std::initializer_list<const char*> names);  // known not to touch the image
  void ignore_labels();                                   // label[x, y], metadata['key'] of a film
  void ignore_all();

  // Children that are objects (bsdf, emitter, film, ...), references resolved. Each must be taken
  // by the caller or refused.
  struct Child {
    const Element* object;
    const Element* place;  // the <ref> or the object
  };
  const std::vector<Child>& children() const { return children_; }
  // The object given as the value of a property (<texture name="reflectance" ...>, or a <ref> with
  // that name), null where there is none; it is taken then.
  const Child* object_of(const std::string& name);
  // Children that object_of has not taken.
  std::vector<Child> rest() const;

  // Properties that were not asked for are findings; they are ignored instead.
  void finish(Findings& findings) const;
  // So are children that are not taken.
  void no_rest(Findings& findings) const;

 private:
  struct Property {
    std::string name;
    const Element* element;
    bool used = false;
  };
  const Property* find(const std::string& name) const;
  Rgb spectrum_plugin(const Element& e, SpectrumOf of) const;
  const Element* take(const std::string& name, std::initializer_list<const char*> tags);

  const Document& document_;
  const Element& object_;
  std::string type_;
  std::vector<Property> properties_;
  std::vector<std::string> asked_;
  std::vector<Child> children_;
  std::vector<const Element*> taken_;  // places
};

}  // namespace photonloom

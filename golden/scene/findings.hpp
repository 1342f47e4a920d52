// SPDX-License-Identifier: Apache-2.0
// Elements of a scene file that are not supported, gathered while it is read, so that one message
// names them all.
#pragma once
#include <set>
#include <string>
#include <vector>

#include "golden/scene/scene.hpp"
#include "golden/scene/xml.hpp"

namespace photonloom {

class Findings {
 public:
  // Notes `what` ("<bsdf type="hair"> is not supported, expected ...") of an element, once, and
  // what stands for it. The caller goes on with that.
  void add(const Element& e, const std::string& what, const std::string& instead) {
    if (!seen_.insert({&e, what}).second) return;
    const std::string place = *e.file + ":" + std::to_string(e.line) + ": ";
    refusals_.push_back(place + what);
    substitutions_.push_back(place + describe(e) + " is not supported: " + instead);
  }

  bool none() const { return refusals_.empty(); }
  // One sentence for one element, else their number and a line for each.
  std::string message() const {
    if (refusals_.size() == 1) return refusals_[0];
    std::string text = std::to_string(refusals_.size()) + " elements are not supported";
    for (const std::string& line : refusals_) text += "\n  " + line;
    return text;
  }
  const std::vector<std::string>& substitutions() const { return substitutions_; }

 private:
  std::set<std::pair<const Element*, std::string>> seen_;
  std::vector<std::string> refusals_, substitutions_;
};

}  // namespace photonloom

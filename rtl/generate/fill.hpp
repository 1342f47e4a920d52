// SPDX-License-Identifier: Apache-2.0
// Text files with named places. A place is @NAME@, NAME of capitals, digits and _, beginning with a
// capital; a value is taken as it is. A place that is alone on its line stands for whole lines:
// none where its value is empty.
#pragma once
#include <map>
#include <string>

namespace photonloom {

using Places = std::map<std::string, std::string>;  // NAME -> value

// The text of `file`, filled. It has every place of `must` and may have those of `may`. Throws
// std::runtime_error naming file, line and place for a place without a value and for one that is
// not closed, and for a place of `must` that the text has not.
std::string fill(const std::string& file, const Places& must, const Places& may = {});

// The same of a text; `file` is its name in errors.
std::string fill_text(const std::string& text, const std::string& file, const Places& must,
                      const Places& may = {});

// rtl/generate/templates/NAME.in, filled.
std::string fill_template(const std::string& name, const Places& must);

}  // namespace photonloom

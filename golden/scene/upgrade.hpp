// SPDX-License-Identifier: Apache-2.0
// Names of older Mitsuba versions become those of 0.6, as Mitsuba's own upgrade rules have it
// (data/schema/upgrade_*.xsl of its sources).
#pragma once
#include "golden/scene/xml.hpp"

namespace photonloom {

// `minor` is the 0.x version of the file. Files of 0.3 have cameras and luminaires, 0.4 has the
// BSDF `bump`; a 0.3 camera looks along +z with +x to the right.
void upgrade(Element& scene, int64_t minor);

}  // namespace photonloom

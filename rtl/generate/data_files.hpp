// SPDX-License-Identifier: Apache-2.0
// Where the files are that the program reads at run time, and where it keeps what it builds.
#pragma once
#include <string>

namespace photonloom {

// The folder of RTL, boards, cell models, plans and scenes, laid out as in the sources (rtl/,
// fpga/, scenes/). Of an installed program it is share/photonloom beside the program's own folder,
// found from where the program lies; otherwise it is the source tree of the build. Where neither is
// there, std::runtime_error names both.
std::string data_dir();

// Whether data_dir() is that of an installed program.
bool is_installed();

// Where models are kept when nothing else is asked for: build/cosim in the current folder; of an
// installed program the user's cache, $XDG_CACHE_HOME/photonloom or ~/.cache/photonloom.
std::string default_work_dir();

// Where a run's own results go when nothing else is asked for: default_work_dir() in a source tree;
// of an installed program the folder cosim of the current folder.
std::string default_results_dir();

}  // namespace photonloom

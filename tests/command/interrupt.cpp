// SPDX-License-Identifier: Apache-2.0
// What an interrupted program leaves behind: nothing of what it had not finished.
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "golden/numeric/output_file.hpp"
#include "tests/catch.hpp"
#include "tests/command/run.hpp"

using namespace photonloom;
using photonloom::test::Scratch;

TEST_CASE("unfinished files and folders are removed, finished ones stay") {
  const Scratch s;
  const pid_t child = fork();
  if (child == 0) {
    write_file(s / "finished", "x");
    OutputFile file(s / "unfinished");
    file.write("half");
    OutputFolder folder(s / "folder");
    write_file(folder.temporary() + "/inside", "half");
    remove_unfinished_outputs();
    _exit(0);
  }
  int status = -1;
  REQUIRE(waitpid(child, &status, 0) == child);
  REQUIRE(WIFEXITED(status));
  CHECK(read_file(s / "finished") == "x");
  CHECK(s.entries() == 1);
}

TEST_CASE("an interrupted render leaves no file and says so by its status") {
  for (const auto& [signal, expected] : {std::pair{"INT", 130}, {"TERM", 143}}) {
    const Scratch s;
    // Far more samples than fit into the time until the signal.
    const std::string command = std::string("timeout --preserve-status -s ") + signal + " 1 '" +
                                photonloom::test::environment("PHOTONLOOM") + "' render '" +
                                photonloom::test::source("scenes/cornell_balls.xml") +
                                "' --integrator path --spp 100000 -o '" + s / "a.exr" +
                                "' --threads 1 2>/dev/null";
    INFO(command);
    const int status = std::system(command.c_str());
    REQUIRE(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == expected);
    CHECK(s.entries() == 0);
  }
}

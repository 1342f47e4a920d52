// SPDX-License-Identifier: Apache-2.0
// What an interrupted program leaves behind: nothing of what it had not finished.
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "golden/numeric/output_file.hpp"
#include "golden/plan/plan_file.hpp"
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
  for (const auto& [signal, expected] : {std::pair{"INT", 130}, {"TERM", 143}, {"HUP", 129}}) {
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

TEST_CASE("what nobody reads ends a command quietly, and leaves nothing unfinished") {
  const Scratch s;
  const auto status_of = [&](const std::string& arguments) {
    const std::string command = "{ '" + photonloom::test::environment("PHOTONLOOM") + "' " +
                                arguments + "; echo $? >'" + s / "status" + "'; } | true";
    INFO(command);
    REQUIRE(std::system(command.c_str()) == 0);
    return read_file(s / "status");
  };
  const std::string scene = "'" + photonloom::test::source("scenes/cornell.xml") + "'";
  // `true` has ended long before a scene is read.
  CHECK(status_of("info " + scene + " 2>'" + s / "err" + "'") == "141\n");
  CHECK(read_file(s / "err").empty());
  const std::string plan = "generate " + scene +
                           " --size 16x16 --spp 1 --gather-rays 2 --photons 500 --k 16 "
                           "--set pixel.fraction_bits=0 -o '" +
                           s / "hw" + "' 2>&1";
  CHECK(status_of(plan + " >/dev/null") == "0\n");
  CHECK(status_of(plan) == "141\n");
  CHECK(s.entries() == 3);  // the status, what was said, the package
}

TEST_CASE("an interrupt while a tool builds a model ends the program, not the tool alone") {
  for (const bool of_terminal : {true, false}) {  // to the group of processes, or to the program
    INFO(of_terminal);
    const Scratch s;
    const std::string plan = s / "plan.toml", packets = s / "in.jsonl", started = s / "started";
    Plan p;
    p.global.present = true;
    p.global.photons = 100;
    p.global.r2_max = p.r2_limit();
    write_plan(p, plan);
    write_file(packets, "");
    // A compiler that takes long.
    write_file(s / "cxx", "#!/bin/sh\n[ \"$1\" != --version ] || { echo slow 1; exit 0; }\n: >'" +
                              started + "'\nexec sleep 20\n");
    std::filesystem::permissions(s / "cxx", std::filesystem::perms::owner_all);
    const std::string program = photonloom::test::environment("PHOTONLOOM"), work = s / "work",
                      output = s / "out.jsonl", error = s / "err", compiler = s / "cxx";
    const pid_t child = fork();
    if (child == 0) {
      setpgid(0, 0);
      setenv("CXX", compiler.c_str(), 1);
      if (!std::freopen(error.c_str(), "w", stderr)) _exit(1);
      execl(program.c_str(), program.c_str(), "replay", "reorder_buffer", "--plan", plan.c_str(),
            "--packets", packets.c_str(), "--backend", "hls", "--work", work.c_str(), "-o",
            output.c_str(), nullptr);
      _exit(1);
    }
    int status = 0;
    while (!std::filesystem::exists(started) && waitpid(child, &status, WNOHANG) == 0) usleep(1000);
    REQUIRE(std::filesystem::exists(started));
    kill(of_terminal ? -child : child, SIGINT);
    REQUIRE(waitpid(child, &status, 0) == child);
    kill(-child, SIGKILL);  // the compiler
    const std::string said = read_file(error);
    INFO(said);
    REQUIRE(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 130);
    CHECK(said.find("interrupted") != std::string::npos);
    CHECK(said.find("failed") == std::string::npos);
    CHECK_FALSE(std::filesystem::exists(output));
  }
}

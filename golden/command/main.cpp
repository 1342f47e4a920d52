// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <exception>

#include "golden/command/command.hpp"

int main(int argc, char** argv) {
  CLI::App app{
      "Photonloom: photon-mapping hardware for one scene at one accuracy, generated and proved.",
      "photonloom"};
  app.require_subcommand(1);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const photonloom::UsageError& error) {
    fmt::print(stderr, "photonloom: {}\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "photonloom: {}\n", error.what());
    return 1;
  }
  return 0;
}

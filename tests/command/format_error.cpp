// SPDX-License-Identifier: Apache-2.0
// --format-error E: golden arithmetic, in the formats that E chooses, stays within E of reference
// arithmetic with the same photons, queries and directions.
#include <fmt/core.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/catch.hpp"
#include "tests/command/run.hpp"

using namespace photonloom::test;

TEST_CASE("--format-error: root of relMSE, mean absolute relative error and bias are within E") {
  const Scratch scratch;
  for (const char* scene : {"cornell_balls", "cornell_glossy"}) {
    double before = 1;
    for (const double error : {0.1, 0.01, 0.001}) {
      const auto image = [&](const char* arithmetic) {
        const std::string file = scratch / (std::string(arithmetic) + ".exr");
        const Outcome o =
            run(fmt::format("render '{}' --arithmetic {} --format-error {} --size 24x24 --spp 2 "
                            "--gather-rays 16 --k 50 "
                            "--photons 20000 --caustic-photons 20000 -o '{}'",
                            source(fmt::format("scenes/{}.xml", scene)), arithmetic, error, file));
        INFO(o.err);
        REQUIRE(o.status == 0);
        return file;
      };
      const std::string golden = image("golden"), reference = image("reference");
      const Outcome o = run(fmt::format("compare '{}' '{}' --json", golden, reference));
      INFO(scene << ", E = " << error << "\n" << o.out << o.err);
      REQUIRE(o.status == 0);
      const auto found = nlohmann::json::parse(o.out);
      const double root = std::sqrt(found["relmse"].get<double>());
      CHECK(root <= error);
      CHECK(found["mape"].get<double>() <= error);
      CHECK(std::fabs(found["mean_ratio"].get<double>() - 1) <= error);
      // A smaller E gives a smaller error; no E gives none.
      CHECK(root < before);
      CHECK(root > 0);
      before = root;
    }
  }
}

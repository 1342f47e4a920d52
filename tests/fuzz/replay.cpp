// SPDX-License-Identifier: Apache-2.0
// Runs each fuzz target once over each file of its folder in the corpus given, with any compiler.
// FUZZ_TARGETS lists the targets: FUZZ_TARGET(name), the function fuzz_name.
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#define FUZZ_TARGET(name) extern "C" int fuzz_##name(const uint8_t* data, size_t size);
#include FUZZ_TARGETS
#undef FUZZ_TARGET

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  bool all = true;
  const auto replay = [&](const std::string& name, int (*target)(const uint8_t*, size_t)) {
    int runs = 0;
    for (const auto& entry :
         std::filesystem::directory_iterator(std::filesystem::path(argv[1]) / name)) {
      std::ifstream file(entry.path(), std::ios::binary);
      const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
      std::printf("%s/%s\n", name.c_str(), entry.path().filename().c_str());
      std::fflush(stdout);
      target(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size());
      ++runs;
    }
    std::printf("%s: %d inputs\n", name.c_str(), runs);
    all = all && runs > 0;
  };
#define FUZZ_TARGET(name) replay(#name, fuzz_##name);
#include FUZZ_TARGETS
#undef FUZZ_TARGET
  return all ? 0 : 1;
}

// SPDX-License-Identifier: Apache-2.0
// Packing, traces and the generated package.
#include <cstdio>
#include <fstream>
#include <random>
#include <string>

#include "golden/packet/layout.hpp"
#include "golden/packet/signature.hpp"
#include "golden/packet/trace.hpp"
#include "rtl/generate/package.hpp"
#include "tests/catch.hpp"

using namespace photonloom;

namespace {

struct Wide {
  uint64_t value;
  static constexpr const char* kName = "wide";
  template <class Visitor>
  static void fields(const Plan&, Visitor&& visitor) {
    visitor(&Wide::value, FieldInfo{"value", 1, 64, "", ""});
  }
};

Plan small_plan() {
  Plan plan;
  plan.global = {true, 1000, 0, 0, 100};
  return plan;
}

template <class P>
P random_packet(const PacketLayout& layout, std::mt19937_64& random) {
  P packet{};
  for (const FieldPlace& f : layout.fields())
    for (int i = 0; i < f.elements; ++i) layout.set(&packet, f, i, random() & ones(f.bits));
  return packet;
}

std::string message(const std::string& line, const Plan& plan) {
  GatherQuery q{};
  try {
    packet_from_json(PacketLayout::of<GatherQuery>(plan), line, "q.jsonl, line 3", &q);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("packing and traces give back what went in, for every packet and many plans") {
  const uint64_t seed = 7;
  INFO("seed " << seed);
  std::mt19937_64 random(seed);
  for (int round = 0; round < 200; ++round) {
    Plan plan = small_plan();
    // Every line that a packet's widths follow from, over its whole range.
    const auto between = [&](int least, int greatest) {
      return least + static_cast<int>(random() % static_cast<uint64_t>(greatest - least + 1));
    };
    plan.position_bits = between(4, 24);
    plan.direction_bits = between(2, 14);
    plan.normal_bits = between(2, 14);
    plan.mantissa_bits = between(2, 16);
    plan.exponent_bits = between(1, 5);
    plan.channels = between(1, 3);
    plan.bucket = 1 << between(1, 4);
    plan.global.photons = random() % (1u << between(1, 30));
    plan.reciprocal_bits = random() % 2 ? between(8, 24) : 0;
    plan.k = between(1, 256);
    plan.cell_bits = between(1, 6);
    plan.probability_bits = between(4, 24);
    plan.u_bits = between(16, 48);
    plan.v_bits = between(1, 12);
    plan.cache_records = between(1, 4096);
    plan.cache_hits = between(1, 8);
    plan.cache_weight_bits = between(4, 12);
    plan.width = between(1, 16384);
    plan.height = between(1, 16384);
    plan.spp = between(1, 1 << 20);
    plan.gather_rays = between(0, 65535);
    for_each_packet([&](auto tag) {
      using P = typename decltype(tag)::type;
      const PacketLayout layout = PacketLayout::of<P>(plan);
      const P packet = random_packet<P>(layout, random);
      std::vector<uint32_t> words(layout.words());
      layout.pack(&packet, words.data());
      P back{};
      layout.unpack(words.data(), &back);
      CHECK(back == packet);
      P read{};
      packet_from_json(layout, packet_to_json(layout, &packet), "here", &read);
      CHECK(read == packet);
    });
  }
}

TEST_CASE("the first field is most significant, element 0 of an array lowest") {
  const Plan plan = small_plan();  // position 16 bits, normal 8
  const PacketLayout layout = PacketLayout::of<GatherQuery>(plan);
  GatherQuery q{};
  q.normal = {0x12, 0x34};
  q.position = {0xaaaa, 0xbbbb, 0xcccc};
  std::vector<uint32_t> words(layout.words());
  layout.pack(&q, words.data());
  CHECK((words[0] & 0xffff) == 0x3412);
  CHECK((words[0] >> 16) == 0xaaaa);
  CHECK(words[1] == 0xccccbbbb);
  q = {};
  q.pixel = static_cast<uint32_t>(ones(plan.pixel_bits()));
  layout.pack(&q, words.data());
  CHECK(to_hex(words.data(), layout.bits()).rfind("0x", 0) == 0);
  CHECK(layout.extract(words.data(), layout.fields()[0], 0) == ones(plan.pixel_bits()));
  CHECK(layout.fields()[0].offset + plan.pixel_bits() == layout.bits());
}

TEST_CASE("a value over its width, or in an absent field, is an error that names it") {
  Plan plan = small_plan();
  const PacketLayout layout = PacketLayout::of<GatherQuery>(plan);
  std::vector<uint32_t> words(layout.words());
  GatherQuery q{};
  q.position[2] = 0x10000;
  CHECK_THROWS_WITH(layout.pack(&q, words.data()),
                    "packet gather_query, field position: 65536 does not fit its 16 bits");
  plan.channels = 1;
  const PacketLayout result = PacketLayout::of<GatherResult>(plan);
  GatherResult r{};
  r.flux[1] = 1;
  std::vector<uint32_t> more(result.words());
  CHECK_THROWS_AS(result.pack(&r, more.data()), std::runtime_error);
}

TEST_CASE("a bad line is one clear error") {
  const Plan plan = small_plan();
  const std::string start = R"({"pixel": 1, "sample": 0, "tag": 0, "map": 0, "flush": 0, )";
  const std::string good = start + R"("want_photons": 0, "position": [1, 2, 3], "normal": [0, 1]})";
  CHECK(message(good, plan).empty());
  CHECK(message(start + R"("position": [1, 2, 3], "normal": [0, 1]})", plan) ==
        "q.jsonl, line 3: field want_photons of a gather_query packet is missing");
  CHECK(message(start + R"("want_photons": 2, "position": [1, 2, 3], "normal": [0, 1]})", plan) ==
        "q.jsonl, line 3: field want_photons is 2, which does not fit its 1 bits");
  CHECK(message(start + R"("want_photons": 0, "position": [1, 2], "normal": [0, 1]})", plan) ==
        "q.jsonl, line 3: field position is [1,2], expected an array of 3 integers");
  CHECK(message(R"({"colour": 1})", plan) ==
        "q.jsonl, line 3: a gather_query packet has no field \"colour\"");
  CHECK(message(R"({"pixel": 1, "pixel": 2})", plan) ==
        "q.jsonl, line 3: field pixel stands twice");
  CHECK(message(R"([1])", plan) ==
        "q.jsonl, line 3: expected one JSON object, a gather_query packet");
  CHECK(message(R"({"pixel": )", plan).find("is not JSON") != std::string::npos);
  CHECK(message(R"({"pixel": 1e999})", plan).find("is not JSON") != std::string::npos);
  for (const int depth : {9, 200000})
    CHECK(message("{\"pixel\": " + std::string(static_cast<size_t>(depth), '[') +
                      std::string(static_cast<size_t>(depth), ']') + "}",
                  plan) ==
          "q.jsonl, line 3: values are nested more than 8 deep, expected one JSON "
          "object, a gather_query packet");
  for (const char* bad : {"-1", "1.5", "true", "\"x\"", "null", "99999999999999999999999"})
    CHECK(message(
              start + R"("want_photons": )" + bad + R"(, "position": [1, 2, 3], "normal": [0, 1]})",
              plan)
              .find("field want_photons is") != std::string::npos);
}

TEST_CASE("integers wider than 53 bits are decimal strings") {
  const PacketLayout layout = PacketLayout::of<Wide>(Plan{});
  const Wide wide{~0ull};
  CHECK(packet_to_json(layout, &wide) == "{\"value\": \"18446744073709551615\"}");
  Wide back{};
  packet_from_json(layout, packet_to_json(layout, &wide), "here", &back);
  CHECK(back.value == wide.value);
}

TEST_CASE("the package is deterministic and follows the plan") {
  Plan plan = small_plan();
  CHECK(write_package(plan, 1) == write_package(plan, 1));
  CHECK(write_package(plan, 1) != write_package(plan, 2));
  plan.reciprocal_bits = 0;
  const std::string text = write_package(plan, 1);
  CHECK(text.find(" reciprocal;") == std::string::npos);
  CHECK(text.find("localparam int unsigned K = 50;") != std::string::npos);
  CHECK(text.find("logic [47:0] position;") != std::string::npos);
  CHECK(upper_camel("reorder_cell_bits") == "ReorderCellBits");
}

TEST_CASE("signature: a shift register that every bit of every result enters, in order") {
  Plan plan = small_plan();
  const uint64_t seed = 3;
  INFO("seed " << seed);
  std::mt19937_64 random(seed);
  for (int round = 0; round < 20; ++round) {
    plan.reciprocal_bits = random() % 2 ? 18 : 0;
    plan.k = 1 + static_cast<int>(random() % 60);
    plan.channels = 1 + static_cast<int>(random() % 3);
    const PacketLayout layout = PacketLayout::of<GatherResult>(plan);
    std::vector<GatherResult> results;
    for (int i = 0; i < 5; ++i) results.push_back(random_packet<GatherResult>(layout, random));

    // The same on single flip-flops: state[i] is x^(63 - i), the feedback that of ECMA-182.
    std::vector<bool> state(64, false);
    const uint64_t ecma = 0x42F0E1EBA9EA3693;
    for (const GatherResult& r : results) {
      std::vector<uint32_t> words(layout.words());
      layout.pack(&r, words.data());
      for (int part = 0; 64 * part < layout.bits(); ++part) {
        std::vector<bool> next(64, false);
        for (int i = 0; i < 64; ++i) {
          const int bit = 64 * part + i;
          const bool in =
              bit < layout.bits() && (words[static_cast<size_t>(bit / 32)] >> (bit % 32) & 1) != 0;
          const bool feedback = state[0] && (ecma >> (63 - i) & 1) != 0;
          next[static_cast<size_t>(i)] =
              (i < 63 && state[static_cast<size_t>(i) + 1]) != (feedback != in);
        }
        state = next;
      }
    }
    uint64_t expected = 0;
    for (int i = 0; i < 64; ++i) expected |= uint64_t{state[static_cast<size_t>(i)]} << i;
    ResultSignature signature(plan);
    for (const GatherResult& r : results) signature.add(r);
    CHECK(signature.value() == expected);
  }
}

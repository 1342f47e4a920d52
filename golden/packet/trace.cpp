// SPDX-License-Identifier: Apache-2.0
#include "golden/packet/trace.hpp"

#include <fmt/core.h>
#include <cerrno>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

namespace photonloom {

std::string packet_to_json(const PacketLayout& layout, const void* packet) {
  std::string text = "{";
  for (const FieldPlace& f : layout.fields()) {
    if (!f.present()) continue;
    if (text.size() > 1) text += ", ";
    text += '"' + f.name + "\": ";
    const char* quote = f.bits > 53 ? "\"" : "";
    if (f.array) text += '[';
    for (int i = 0; i < f.elements; ++i)
      text += fmt::format("{}{}{}{}", i ? ", " : "", quote, layout.get(packet, f, i), quote);
    if (f.array) text += ']';
  }
  return text + "}";
}

namespace {

uint64_t parse_value(const nlohmann::json& v, const FieldPlace& f, const std::string& where) {
  uint64_t value = 0;
  bool good = false;
  if (v.is_number_unsigned()) {
    value = v.get<uint64_t>();
    good = true;
  } else if (v.is_string()) {
    const std::string& digits = v.get_ref<const std::string&>();
    if (!digits.empty() && digits.find_first_not_of("0123456789") == std::string::npos) {
      errno = 0;
      value = std::strtoull(digits.c_str(), nullptr, 10);
      good = errno == 0;
    }
  }
  if (!good)
    throw std::runtime_error(
        fmt::format("{}: field {} is {}, expected an unsigned integer of at most {} bits", where,
                    f.name, v.dump(), f.bits));
  if (value > ones(f.bits))
    throw std::runtime_error(fmt::format("{}: field {} is {}, which does not fit its {} bits",
                                         where, f.name, value, f.bits));
  return value;
}

}  // namespace

void packet_from_json(const PacketLayout& layout, std::string_view line, const std::string& where,
                      void* packet) {
  using nlohmann::json;
  constexpr int kDeepest = 8;
  std::set<std::string> seen;
  std::string repeated;
  json object;
  bool deep = false;
  try {
    object = json::parse(line, [&](int depth, json::parse_event_t event, json& parsed) {
      // A packet is an object of numbers and of arrays of them. What lies deeper is not kept: a
      // library that prints it calls itself as often.
      if (depth > kDeepest) deep = true;
      if (deep) return false;
      if (event == json::parse_event_t::key && depth == 1 &&
          !seen.insert(parsed.get<std::string>()).second)
        repeated = parsed.get<std::string>();
      return true;
    });
  } catch (const json::parse_error& error) {
    throw std::runtime_error(fmt::format("{}: is not JSON, at character {}", where, error.byte));
  } catch (const json::out_of_range&) {
    throw std::runtime_error(fmt::format("{}: is not JSON of numbers up to 1e308", where));
  }
  if (deep)
    throw std::runtime_error(fmt::format(
        "{}: values are nested more than {} deep, expected one JSON object, a {} packet", where,
        kDeepest, layout.name()));
  if (!object.is_object())
    throw std::runtime_error(
        fmt::format("{}: expected one JSON object, a {} packet", where, layout.name()));
  if (!repeated.empty())
    throw std::runtime_error(fmt::format("{}: field {} stands twice", where, repeated));
  for (const auto& [key, value] : object.items()) {
    const FieldPlace* f = layout.find(key);
    if (!f)
      throw std::runtime_error(
          fmt::format("{}: a {} packet has no field {}", where, layout.name(), json(key).dump()));
    if (!f->present())
      throw std::runtime_error(fmt::format("{}: field {} is absent from {} packets with this plan",
                                           where, key, layout.name()));
  }
  for (const FieldPlace& f : layout.fields()) {
    for (int i = 0; i < f.member_elements; ++i) layout.set(packet, f, i, 0);
    if (!f.present()) continue;
    const auto value = object.find(f.name);
    if (value == object.end())
      throw std::runtime_error(
          fmt::format("{}: field {} of a {} packet is missing", where, f.name, layout.name()));
    if (!f.array) {
      layout.set(packet, f, 0, parse_value(*value, f, where));
      continue;
    }
    if (!value->is_array() || value->size() != static_cast<size_t>(f.elements))
      throw std::runtime_error(fmt::format("{}: field {} is {}, expected an array of {} integers",
                                           where, f.name, value->dump(), f.elements));
    for (int i = 0; i < f.elements; ++i)
      layout.set(packet, f, i, parse_value((*value)[static_cast<size_t>(i)], f, where));
  }
}

}  // namespace photonloom

// SPDX-License-Identifier: Apache-2.0
#include "report/payload.hpp"

#include <zlib.h>

#include <cstdint>
#include <limits>
#include <stdexcept>

namespace photonloom {
namespace {

std::string deflated(std::string_view bytes, int strategy) {
  if (bytes.size() > std::numeric_limits<uInt>::max())
    throw std::runtime_error(
        "a report's part has 4 GiB or more, which one zlib call does not take");
  z_stream stream{};
  // 15 and 8: zlib's usual window and memory.
  if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, 15, 8, strategy) != Z_OK)
    throw std::runtime_error("zlib: compression failed");
  std::string out(deflateBound(&stream, static_cast<uLong>(bytes.size())), '\0');
  // zlib reads only.
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  const int status = deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  if (status != Z_STREAM_END) throw std::runtime_error("zlib: compression failed");
  return out;
}

std::string base64(std::string_view bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t three = 0;
    for (size_t j = 0; j < 3; ++j)
      three = three << 8 | (i + j < bytes.size() ? static_cast<uint8_t>(bytes[i + j]) : 0u);
    for (size_t j = 0; j < 4; ++j)
      text += i + j > bytes.size() ? '=' : kDigits[three >> (18 - 6 * j) & 63];
  }
  return text;
}

}  // namespace

std::string packed_text(std::string_view bytes, Content content) {
  return base64(deflated(bytes, content == Content::kText ? Z_DEFAULT_STRATEGY : Z_FILTERED));
}

}  // namespace photonloom

// SPDX-License-Identifier: Apache-2.0
#include "golden/numeric/bits.hpp"

#include <algorithm>

namespace photonloom {

std::string to_decimal(Int128 x) {
  const bool negative = x < 0;
  UInt128 u = negative ? -static_cast<UInt128>(x) : static_cast<UInt128>(x);
  std::string digits;
  do {
    digits.push_back(static_cast<char>('0' + static_cast<int>(u % 10)));
    u /= 10;
  } while (u != 0);
  if (negative) digits.push_back('-');
  std::reverse(digits.begin(), digits.end());
  return digits;
}

}  // namespace photonloom

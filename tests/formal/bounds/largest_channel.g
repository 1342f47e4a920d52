# SPDX-License-Identifier: Apache-2.0
# encode_power: x is the largest channel over 2^e, e > 0. A step less did not do: floor(double(2 x + 1/2)) was 2^m or more, and a
# double below 2^m has the spacing 2^(m - 53).
sum = float<ieee_64,ne>(x + 1b-1);
code = fixed<0,dn>(sum);
{ x in [$(2^(m - 1) - 1/4 - 2^(m - 55)), $(2^m)] -> |(code - x) / x| <= $down(bound) }
code - x -> (code - sum) + ((sum - (x + 1b-1)) + 1b-1);

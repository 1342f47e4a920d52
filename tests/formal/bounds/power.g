# SPDX-License-Identifier: Apache-2.0
# encode_power: x is a channel over 2^e.
sum = float<ieee_64,ne>(x + 1b-1);
code = fixed<0,dn>(sum);
{ x in [0, $(2^m)] -> |code - x| <= $(bound) }
code - x -> (code - sum) + ((sum - (x + 1b-1)) + 1b-1);

# SPDX-License-Identifier: Apache-2.0
# quantise_normal: n is a coordinate of a unit vector.
sum = float<ieee_64,ne>(n + 1);
code = fixed<0,dn>(sum * $(2^(b - 1)));
exact = (n + 1) * $(2^(b - 1));
{ n in [-1, 1] -> code - exact in [$(-bound), $(bound - 1)] }
code - exact -> (code - sum * $(2^(b - 1))) + (sum - (n + 1)) * $(2^(b - 1));

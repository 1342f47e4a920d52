# SPDX-License-Identifier: Apache-2.0
# Shader::weight: y is the double's fraction over 2^-w, off by bound_area of the true value y / (1 + off).
sum = float<ieee_64,ne>(y + 1b-1);
code = fixed<0,dn>(sum);
exact = y / (1 + off);
{ y in [$(2^(w - 1)), $(2^w)] /\ off in [-7b-53, 7b-53] -> |(code - exact) / exact| <= $(bound) }
(code - exact) / exact -> (code - y) / y * (1 + off) + off { y <> 0, off <> -1 };
code - y -> (code - sum) + ((sum - (y + 1b-1)) + 1b-1);

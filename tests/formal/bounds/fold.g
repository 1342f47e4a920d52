# SPDX-License-Identifier: Apache-2.0
# oct_fold and the sum of oct_encode in doubles: x, y, z are magnitudes. What is on top, x / sum, and what is folded over,
# 1 - x / sum; a coordinate of 0 stays 0. Upper and lower are the places plus 1 on the square, whose edge is 2.
@double = float<ieee_64,ne>;
sum = x + y + z;
xy = double(x + y);
sum_d = double(xy + z);
inv = double(1 / sum_d);
s = double(x * inv);
exact = x / sum;
upper = double(1 + s);
folded = double(1 - s);
lower = double(1 + folded);
sum_off = (sum_d - sum) / sum;
{ x in [1b-300, 2] /\ y in [1b-300, 2] /\ z in [1b-300, 2] /\ sum in [1, 2] /\ exact in [1b-301, 1]
  -> upper - (1 + exact) in [-1b-50, 1b-50] /\ lower - (2 - exact) in [-1b-50, 1b-50] }
sum_off -> (sum_d - (xy + z)) / sum + (xy - (x + y)) / sum { sum <> 0 };
upper - (1 + exact) -> (upper - (1 + s)) + (s - exact) { sum <> 0 };
lower - (2 - exact) -> (lower - (1 + folded)) + (folded - (1 - s)) - (s - exact) { sum <> 0 };
s - exact -> (s - x * inv) + x * (inv - 1 / sum_d) + exact * (1 / (1 + sum_off) - 1) { sum <> 0, sum_d <> 0, 1 + sum_off <> 0 };

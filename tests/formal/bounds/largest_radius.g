# SPDX-License-Identifier: Apache-2.0
# radius_to_r2_max. The unit's power of two scales radius and unit alike.
@double = float<ieee_64,ne>;
exact_r = radius / unit;
r = double(exact_r);
square = double(r * r);
r2 = fixed<0,dn>(square);
exact = exact_r * exact_r;
{ radius in [0, $(2^(p + 2))] /\ unit in [1, 2] /\ exact_r in [0, $(2^(p + 1))] -> r2 - exact in [$(-bound), $(bound - 1)] }
r2 - exact -> (r2 - square) + (square - r * r) + (r - exact_r) * (r + exact_r) { unit <> 0 };

# SPDX-License-Identifier: Apache-2.0
# d2 of two quantised points: whole, and in 2p + 2 bits.
x = x1 - x2;
y = y1 - y2;
z = z1 - z2;
exact = x * x + y * y + z * z;
d2 = fixed<0,dn>(exact);
{ @FIX(x1, 0) /\ x1 in [0, $(2^p - 1)] /\ @FIX(y1, 0) /\ y1 in [0, $(2^p - 1)] /\ @FIX(z1, 0) /\ z1 in [0, $(2^p - 1)] /\
  @FIX(x2, 0) /\ x2 in [0, $(2^p - 1)] /\ @FIX(y2, 0) /\ y2 in [0, $(2^p - 1)] /\ @FIX(z2, 0) /\ z2 in [0, $(2^p - 1)]
  -> d2 - exact in [$(-bound), $(bound)] /\ d2 in [0, $(2^(2 * p + 2) - 1)] }

# SPDX-License-Identifier: Apache-2.0
# Two quantised points: by what their difference moves. Each coordinate x1 is off by what bound_position proves.
x = x1 - x2;
y = y1 - y2;
z = z1 - z2;
{ x1 in [$(-1 - 2^(p - 50)), $(2^(p - 50))] /\ y1 in [$(-1 - 2^(p - 50)), $(2^(p - 50))] /\ z1 in [$(-1 - 2^(p - 50)), $(2^(p - 50))] /\
  x2 in [$(-1 - 2^(p - 50)), $(2^(p - 50))] /\ y2 in [$(-1 - 2^(p - 50)), $(2^(p - 50))] /\ z2 in [$(-1 - 2^(p - 50)), $(2^(p - 50))]
  -> x * x + y * y + z * z <= $(bound^2) }

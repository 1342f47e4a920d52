# SPDX-License-Identifier: Apache-2.0
# cache_weight, where it is not 0: x is the reach's square over 2^(exponent - w), d the squared distance over 2^(exponent + 1 - w),
# v that of the normals over 2^(angle_bits - B), w = B + 4 the bits of the reciprocal.
m = fixed<0,na>(x);
q = $(4^(B + 4)) / m;
R = fixed<0,dn>(q);
a = fixed<0,dn>(d);
y = a * R * $(2^(-B - 7));
far = fixed<0,dn>(y);
near = fixed<0,dn>(v);
got = $(2^B) - far - near;
due = $(2^B) - d / x * $(2^(B + 1)) - v;
off = R * x * $(4^(-B - 4)) - 1;
{ @FIX(x, -64) /\ x in [$(2^(B + 4) - 1/4), $(2^(B + 5) - 1/4)] /\ @FIX(d, -64) /\ d in [0, $(2^(B + 4))] /\ v in [0, $(2^B)] /\ got >= 1
  -> got - due in [-1b-4, $(bound)] }
off -> ((R - q) / q + 1) * (1 + (x - m) / m) - 1 { q <> 0, m <> 0 };
got - due -> (y - far) + (v - near) + ((d - a) / x - a / x * off) * $(2^(B + 1)) { x <> 0 };

# SPDX-License-Identifier: Apache-2.0
# reciprocal: x is the integer over 2^(exponent - W). Where rounding carries, x lies just below 2^W.
m = fixed<0,na>(x);
q = $(4^W) / m;
R = fixed<0,dn>(q);
off = R * x * $(4^-W) - 1;
{ @FIX(x, -64) /\ x in [$(2^W - 1/4), $(2^(W + 1) - 1/4)] -> off in [$(-bound), $(2^-(W + 1))] }
off -> ((R - q) / q + 1) * (1 + (x - m) / m) - 1 { q <> 0, m <> 0 };

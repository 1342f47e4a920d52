# SPDX-License-Identifier: Apache-2.0
# The constant c of a full result, in 2^-W.
exact = (k - 1) * $(2^W) / k;
c = fixed<0,dn>(exact + 1b-1);
{ @FIX(k, 0) /\ k in [2, 256] -> |c - exact| <= $(bound * 2^W) }
c - exact -> (c - (exact + 1b-1)) + 1b-1 { k <> 0 };

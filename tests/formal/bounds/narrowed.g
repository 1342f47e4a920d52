# SPDX-License-Identifier: Apache-2.0
# build_sample_table: y is an exact weight over 2^s.
w = fixed<0,dn>(y);
{ @FIX(y, -40) /\ y in [1, 1b30] -> w - y in [$(-bound), 0] }

# SPDX-License-Identifier: Apache-2.0
# scaled of golden/unit/shader.cpp: y is an integer over a power of two.
q = fixed<0,dn>(y + 1b-1);
{ @FIX(y, -127) /\ y in [0, 1b127] -> |q - y| <= $(bound) }
q - y -> (q - (y + 1b-1)) + 1b-1;

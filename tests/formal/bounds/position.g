# SPDX-License-Identifier: Apache-2.0
# quantise_position. t is a coordinate above the cube's origin, E the cube's edge; other powers of two of E scale all alike.
@double = float<ieee_64,ne>;
d = double(t);
exact_scale = $(2^p) / E;
scale = double(exact_scale);
c = double(d * scale);
q = fixed<0,dn>(c);
exact = t * exact_scale;
{ t in [0, 2] /\ E in [1, 2] -> q - exact in [$(-bound), $(bound - 1)] }
q - exact -> (q - c) + ((c - d * scale) + d * (scale - exact_scale) + (d - t) * exact_scale) { E <> 0 };

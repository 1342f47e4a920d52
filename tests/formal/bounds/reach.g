# SPDX-License-Identifier: Apache-2.0
# cache_falloff before the reciprocal. Powers of two of accuracy, radius and unit scale all alike.
@double = float<ieee_64,ne>;
exact_way = accuracy * radius;
way = double(exact_way);
exact_reach = exact_way / unit;
reach = double(way / unit);
product = double(reach * reach);
square = fixed<0,dn>(product);
exact = exact_reach * exact_reach;
{ accuracy in [1, 2] /\ radius in [0, $(2^(p + 2))] /\ unit in [1, 2] /\ exact_reach in [0, $(2^(p + 1))]
  -> square - exact in [$(-bound), $(bound - 1)] }
square - exact -> (square - product) + (product - reach * reach) + (reach - exact_reach) * (reach + exact_reach) { unit <> 0 };
reach - exact_reach -> (reach - way / unit) + (way - exact_way) / unit { unit <> 0 };

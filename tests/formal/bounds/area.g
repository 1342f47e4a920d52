# SPDX-License-Identifier: Apache-2.0
# Shader::weight before it is rounded: weight / (pi unit^2), with one channel times its colour. pi is kPi, off by less than 2^-54.
# Powers of two scale all alike.
@double = float<ieee_64,ne>;
pi = 884279719003555b-48;
square = double(unit * unit);
area = double(pi * square);
inverse = double(1 / area);
value = double(weight * inverse);
result = double(value * colour);
exact_square = unit * unit;
exact_area = pi * (1 + pi_off) * exact_square;
exact_inverse = 1 / exact_area;
exact_value = weight * exact_inverse;
exact = exact_value * colour;
{ unit in [1, 2] /\ weight in [1, 2] /\ colour in [1, 2] /\ pi_off in [-1b-54, 1b-54] -> (result - exact) / exact in [-6b-53, 6b-53] }
(result - exact) / exact ->
  (1 + (result - value * colour) / (value * colour)) * (1 + (value - weight * inverse) / (weight * inverse)) *
  (1 + (inverse - 1 / area) / (1 / area)) * (1 + pi_off) /
  ((1 + (area - pi * square) / (pi * square)) * (1 + (square - exact_square) / exact_square)) - 1
  { value <> 0, colour <> 0, weight <> 0, inverse <> 0, area <> 0, square <> 0, unit <> 0, pi_off <> -1 };

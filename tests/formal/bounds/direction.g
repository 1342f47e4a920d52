# SPDX-License-Identifier: Apache-2.0
# oct_encode and oct_decode: s and t are the place on the square, e and f what doubles lose of it (bound_fold). The way from the
# place to the cell's centre, on the faces of the octahedron, has the length |(ds, dt, ds + dt)|, folded over or not. x, y and
# 1 - x - y are the coordinates of any point of a face: it is at least 1 / sqrt(3) from the middle. From there a way of length l
# in a face is seen under at most l sqrt(3).
u = fixed<0,dn>((s + e + 1) * $(2^(b - 1)));
v = fixed<0,dn>((t + f + 1) * $(2^(b - 1)));
ds = (2 * u + 1) * $(2^-b) - 1 - s;
dt = (2 * v + 1) * $(2^-b) - 1 - t;
z = 1 - x - y;
away = x * x + y * y + z * z;
{ s in [-1, 1] /\ t in [-1, 1] /\ e in [-1b-50, 1b-50] /\ f in [-1b-50, 1b-50] /\ x in [0, 1] /\ y in [0, 1]
  -> 3 * (ds * ds + dt * dt + (ds + dt) * (ds + dt)) <= $(bound^2) /\ 3 * away - 1 >= 0 }
ds -> (u - (s + e + 1) * $(2^(b - 1)) + 1b-1) * $(2^(1 - b)) + e;
dt -> (v - (t + f + 1) * $(2^(b - 1)) + 1b-1) * $(2^(1 - b)) + f;
3 * away - 1 -> (x - y) * (x - y) + (y - z) * (y - z) + (z - x) * (z - x);

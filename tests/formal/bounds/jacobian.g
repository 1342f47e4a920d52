# SPDX-License-Identifier: Apache-2.0
# cell_jacobian: r2 = |o|^2 of a cell's centre, which is within the sphere through the octahedron's corners.
exact = $(28 * 16^a) / (r2 * r2);
J = fixed<0,dn>(exact);
part = (J - exact) / exact * $(1 / bound);
{ @FIX(r2, 0) /\ r2 in [1, $(4^a)] -> part in [-1, 0] }
part -> (J - exact) * $(1 / bound) / exact { exact <> 0 };

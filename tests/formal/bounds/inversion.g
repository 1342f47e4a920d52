# SPDX-License-Identifier: Apache-2.0
# sample_cell: a cell takes the codes u with F <= floor(u total / 2^n) < F + w, from the least with u >= F 2^n / total on.
low = F * $(2^u) / total;
high = (F + w) * $(2^u) / total;
first = fixed<0,up>(low);
last = fixed<0,up>(high);
codes = last - first;
exact = w * $(2^u) / total;
{ @FIX(F, 0) /\ F in [0, 1b36] /\ @FIX(w, 0) /\ w in [0, 1b36] /\ @FIX(total, 0) /\ total in [1, 1b36] -> |codes - exact| <= $(bound * 2^u) }
codes - exact -> (last - high) - (first - low) { total <> 0 };

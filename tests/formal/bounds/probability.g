# SPDX-License-Identifier: Apache-2.0
# w and the table's total beside what they are of: share of the exact weights' sum, sum in units of a weight. A weight is off by at
# most 1 (bound_narrowed), the total by at most 4^a.
w = share * sum + off;
total = sum + total_off;
limit = $(bound);
{ share in [0, 1] /\ sum in [1b-10, 1b31] /\ off in [-1, 1] /\ total_off in [$(-4^a), $(4^a)] /\ total in [1, 1b32]
  -> w / total - share - limit <= 0 /\ w / total - share + limit >= 0 }
w / total - share - limit -> (off - share * total_off - $(1 + 4^a)) / total { total <> 0 };
w / total - share + limit -> (off - share * total_off + $(1 + 4^a)) / total { total <> 0 };

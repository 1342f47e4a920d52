# SPDX-License-Identifier: Apache-2.0
"""scripts/headline: the plans (plans), the digest of a netlist (netlist), routed tops and what the link carries (tops, link),
simulations and the timing of a core (simulation), a replay on a whole board (replay), the rows (rows) and what is kept of
them (data), what is judged (verdict) and written (page), and the command."""

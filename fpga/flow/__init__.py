# SPDX-License-Identifier: Apache-2.0
"""From a plan to counts, clocks and bitstreams: what scripts/fpga, headline, fpga-plans and area-check do.

Each module uses only those named before it: shell (commands, files), boards (fpga/boards), goals (fpga/goals.toml), tools
(where they are, which version), package (photonloom), synthesis (Yosys), routing (nextpnr), results (the report of
scripts/fpga), tables (Markdown). On them stand the commands: measure (scripts/fpga), area (scripts/area-check), headline and
plans (scripts/fpga-plans).
"""

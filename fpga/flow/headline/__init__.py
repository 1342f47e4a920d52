# SPDX-License-Identifier: Apache-2.0
"""scripts/headline: routed tops and their simulation (tops), what the link carries (link), a plan's rows beside one core
(rows), what is written of them (page), and the command."""

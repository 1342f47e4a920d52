# SPDX-License-Identifier: Apache-2.0
"""scripts/fpga-plans: the plans (catalogue), what they measure (measurements), what predicts it (fit), what is written of
both (pages), and the command."""

// SPDX-License-Identifier: Apache-2.0
// Stub of a 7-series PLL, for lint alone: the ports and parameters that tops use, no behaviour. Synthesis has its own.
/* verilator lint_off UNUSED */
/* verilator lint_off UNDRIVEN */
module PLLE2_BASE #(
    parameter real CLKIN1_PERIOD = 0,
    parameter int CLKFBOUT_MULT = 5,
    parameter int DIVCLK_DIVIDE = 1,
    parameter int CLKOUT0_DIVIDE = 1
) (
    input  logic CLKIN1,
    input  logic CLKFBIN,
    input  logic RST,
    input  logic PWRDWN,
    output logic CLKFBOUT,
    output logic CLKOUT0,
    output logic LOCKED
);
endmodule

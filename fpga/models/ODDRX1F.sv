// SPDX-License-Identifier: Apache-2.0
// Stub of the ECP5's output register of two edges, for lint alone: no behaviour. Synthesis has its own.
/* verilator lint_off UNUSED */
/* verilator lint_off UNDRIVEN */
module ODDRX1F (
    input  logic SCLK,
    input  logic RST,
    input  logic D0,
    input  logic D1,
    output logic Q
);
endmodule

// SPDX-License-Identifier: Apache-2.0
// Stub of the ECP5's bidirectional pad, for lint alone: no behaviour. Synthesis has its own.
/* verilator lint_off UNUSED */
/* verilator lint_off UNDRIVEN */
module BB (
    input  logic I,
    input  logic T,
    output logic O,
    inout  wire  B
);
endmodule

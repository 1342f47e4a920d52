// SPDX-License-Identifier: Apache-2.0
// Stub of a 7-series global clock buffer, for lint alone: no behaviour. Synthesis has its own.
/* verilator lint_off UNUSED */
/* verilator lint_off UNDRIVEN */
module BUFG (
    input  logic I,
    output logic O
);
endmodule

// SPDX-License-Identifier: Apache-2.0
// a < b of unsigned numbers, as the borrow of a subtraction: one carry chain. A comparison left to the synthesizer may
// become a chain and a tree for the equality beside it, slower and larger. Combinational.
module less_than #(
    parameter int unsigned Width = 34
) (
    input  logic [Width-1:0] a_i,
    input  logic [Width-1:0] b_i,
    output logic             less_o
);
  /* verilator lint_off UNUSEDSIGNAL */  // only the borrow
  logic [Width:0] difference;
  /* verilator lint_on UNUSEDSIGNAL */

  assign difference = {1'b0, a_i} - {1'b0, b_i};
  assign less_o = difference[Width];
endmodule

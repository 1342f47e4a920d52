// SPDX-License-Identifier: Apache-2.0
// Counts the cycles in which event_i is 1, modulo 2^Width. Cleared by reset.
module counter #(
    parameter int unsigned Width = 32
) (
    input  logic             clk_i,
    input  logic             rst_i,
    input  logic             event_i,
    output logic [Width-1:0] count_o
);
  always_ff @(posedge clk_i) begin
    if (event_i) count_o <= count_o + 1'b1;
    if (rst_i) count_o <= '0;
  end
endmodule

// SPDX-License-Identifier: Apache-2.0
// A stream register for two words: cuts every path between its two sides. Latency 1, one word a cycle; in_ready_o and
// out_valid_o come from registers.
module skid_buffer #(
    parameter int unsigned Width = 8
) (
    input  logic             clk_i,
    input  logic             rst_i,
    input  logic             in_valid_i,
    output logic             in_ready_o,
    input  logic [Width-1:0] in_i,
    output logic             out_valid_o,
    input  logic             out_ready_i,
    output logic [Width-1:0] out_o
);
  logic main_valid_q, spare_valid_q;
  logic [Width-1:0] main_q, spare_q;

  assign in_ready_o  = !spare_valid_q;
  assign out_valid_o = main_valid_q;
  assign out_o       = main_q;

  always_ff @(posedge clk_i) begin
    if (out_ready_i || !main_valid_q) begin
      main_q <= spare_valid_q ? spare_q : in_i;
      main_valid_q <= spare_valid_q || in_valid_i;
      spare_valid_q <= 1'b0;
    end else if (in_valid_i && !spare_valid_q) begin
      spare_q <= in_i;
      spare_valid_q <= 1'b1;
    end
    if (rst_i) begin
      main_valid_q  <= 1'b0;
      spare_valid_q <= 1'b0;
    end
  end
endmodule

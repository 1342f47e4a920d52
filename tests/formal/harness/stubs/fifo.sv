// SPDX-License-Identifier: Apache-2.0
// In place of fifo where its depth does not matter: the same four words deep, and eight where it is 32 or more. That the real
// one keeps its words is proved by itself.
module fifo #(
    parameter int unsigned Width = 8,
    parameter int unsigned Depth = 16
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
  // Words in a row, the oldest lowest: no pointers.
  localparam int unsigned Words = Depth < 4 ? Depth : Depth < 32 ? 4 : 8;
  logic [Words-1:0] valid_q;
  logic [Words*Width-1:0] words_q;
  logic push, pop;
  assign in_ready_o = !valid_q[Words-1];
  assign out_valid_o = valid_q[0];
  assign out_o = words_q[0+:Width];
  assign push = in_valid_i && in_ready_o;
  assign pop = out_valid_o && out_ready_i;

  // What is left once the oldest has gone, and the place behind it.
  logic [Words-1:0] left;
  logic [Words*Width-1:0] words;
  assign left  = pop ? valid_q >> 1 : valid_q;
  assign words = pop ? words_q >> Width : words_q;
  always_ff @(posedge clk_i) begin
    valid_q <= left;
    words_q <= words;
    if (push) begin
      valid_q <= {left[Words-2:0], 1'b1};
      for (int unsigned i = 0; i < Words; i++) begin
        if (!left[i] && (i == 0 || left[(i+Words-1)%Words])) words_q[Width*i+:Width] <= in_i;
      end
    end
    if (rst_i) valid_q <= '0;
  end
endmodule

// SPDX-License-Identifier: Apache-2.0
// Whether a FIFO has room for a word, from a register, where the comparison of its pointers would be late: of Depth places three
// stay free, for words that went in when room_o was made. A word goes in only while room_o. room_o follows a word that
// went out 3 cycles later.
module room_ahead #(
    parameter int unsigned Depth = 16,
    localparam int unsigned FillBits = $clog2(Depth + 1)
) (
    input  logic clk_i,
    input  logic rst_i,
    input  logic push_i,
    input  logic pop_i,
    output logic room_o
);
  logic pushed_q, popped_q;
  logic [FillBits-1:0] fill_q;

  always_ff @(posedge clk_i) begin
    pushed_q <= push_i && !rst_i;
    popped_q <= pop_i && !rst_i;
    fill_q <= rst_i ? '0 : fill_q + FillBits'(pushed_q) - FillBits'(popped_q);
    room_o <= !rst_i && fill_q <= FillBits'(Depth - 3);
  end
endmodule

// SPDX-License-Identifier: Apache-2.0
// Whether the bits of a word, its parity bit among them, are odd in number: what was read then is not what was written.
// Latency 1, a word a cycle: the bits are combined by sixteens before the register, which follows a block RAM, and their
// results behind it.
module parity_check #(
    parameter int unsigned Width = 9
) (
    input  logic             clk_i,
    input  logic [Width-1:0] word_i,
    output logic             wrong_o
);
  localparam int unsigned Groups = (Width + 15) / 16;
  logic [Groups-1:0] odd_q;

  for (genvar g = 0; g < Groups; g++) begin : gen_group
    localparam int unsigned Bits = Width - 16 * g < 16 ? Width - 16 * g : 16;
    always_ff @(posedge clk_i) odd_q[g] <= ^word_i[16*g+:Bits];
  end
  assign wrong_o = ^odd_q;
endmodule

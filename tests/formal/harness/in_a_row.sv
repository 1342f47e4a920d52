// SPDX-License-Identifier: Apache-2.0
// The words of those places that hold one, in their order and without gaps, each below its valid bit; place 0 comes lowest.
// Two stores hold the same words in the same order iff their rows are equal, wherever in them the words stand.
module in_a_row #(
    parameter int unsigned Places = 2,
    parameter int unsigned Width = 1
) (
    input  logic [          Places-1:0] valid_i,
    input  logic [    Places*Width-1:0] words_i,
    output logic [Places*(Width+1)-1:0] row_o
);
  always_comb begin
    row_o = '0;
    for (int unsigned i = 0; i < Places; i++) begin
      if (valid_i[Places-1-i]) row_o = {row_o, 1'b1, words_i[Width*(Places-1-i)+:Width]};
    end
  end
endmodule

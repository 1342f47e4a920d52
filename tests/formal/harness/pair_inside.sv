// SPDX-License-Identifier: Apache-2.0
// What the words inside have to be so that stream_checks never fails: read from the oldest, place 0, to the newest, they go on
// where what was taken ends and end where what was sent ends, and the two words 1 come on end.
module pair_inside #(
    parameter int unsigned Places = 2
) (
    input logic              rst_i,
    input logic [       1:0] sent_i,   // words 1 so far, as stream_checks counts them
    input logic [       1:0] taken_i,
    input logic [Places-1:0] valid_i,
    input logic [Places-1:0] words_i
);
  logic [1:0] seen;
  logic fits;
  always_comb begin
    seen = taken_i;
    fits = 1'b1;
    for (int unsigned i = 0; i < Places; i++) begin
      if (valid_i[i]) begin
        if ((seen == 2'd1 && !words_i[i]) || (seen == 2'd2 && words_i[i])) fits = 1'b0;
        seen = seen + {1'b0, words_i[i]};
      end
    end
    if (!rst_i) assert (fits && seen == sent_i);
  end
endmodule

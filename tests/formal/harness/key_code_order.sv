// SPDX-License-Identifier: Apache-2.0
// sources: rtl/photon_gatherer/photon_gatherer_key_code.sv
// photon_gatherer_key_code: codes are in the order of their keys, of those of k = 50 with 16-bit coordinates and of others; and keys
// below the first mantissa's limit have codes of their own.
module key_code_order #(
    parameter int unsigned KeyBits = 42,
    parameter int unsigned CodeBits = 20,
    parameter int unsigned ExponentBits = 3
) (
    input logic clk_i
);
  logic started_q = 1'b0;
  always_ff @(posedge clk_i) started_q <= 1'b1;

  (* anyseq *) logic [KeyBits-1:0] key_a, key_b;
  logic [CodeBits-1:0] a, b;
  photon_gatherer_key_code #(
      .KeyBits(KeyBits),
      .CodeBits(CodeBits),
      .ExponentBits(ExponentBits)
  ) code_a (
      .key_i(key_a),
      .code_o(a)
  );
  photon_gatherer_key_code #(
      .KeyBits(KeyBits),
      .CodeBits(CodeBits),
      .ExponentBits(ExponentBits)
  ) code_b (
      .key_i(key_b),
      .code_o(b)
  );
  always_comb begin
    if (started_q && key_a < key_b) begin
      assert (a <= b);
      if (64'(key_b) < 64'd1 << (CodeBits - ExponentBits)) assert (a < b);
    end
  end
endmodule

// SPDX-License-Identifier: Apache-2.0
// sources: rtl/photon_gatherer/photon_gatherer_key_code.sv rtl/photon_gatherer/photon_gatherer_known_code.sv
// photon_gatherer_known_code: as photon_gatherer_candidates and photon_gatherer_coded_list have it, the exponent is found of a distance
// alone, before the last bits of the key, the index, are known.
module known_code #(
    parameter int unsigned KeyBits = 42,
    parameter int unsigned LowBits = 8,
    parameter int unsigned CodeBits = 20,
    parameter int unsigned ExponentBits = 3
) (
    input logic clk_i
);
  logic started_q = 1'b0;
  always_ff @(posedge clk_i) started_q <= 1'b1;

  (* anyseq *) logic [KeyBits-1:0] key;
  logic [CodeBits-1:0] whole, without, known;
  photon_gatherer_key_code #(
      .KeyBits(KeyBits),
      .CodeBits(CodeBits),
      .ExponentBits(ExponentBits)
  ) code_whole (
      .key_i(key),
      .code_o(whole)
  );
  photon_gatherer_key_code #(
      .KeyBits(KeyBits),
      .CodeBits(CodeBits),
      .ExponentBits(ExponentBits)
  ) code_without (
      .key_i({key[KeyBits-1:LowBits], LowBits'(0)}),
      .code_o(without)
  );
  photon_gatherer_known_code #(
      .KeyBits(KeyBits),
      .CodeBits(CodeBits),
      .ExponentBits(ExponentBits)
  ) dut (
      .key_i(key),
      .exponent_i(without[CodeBits-1-:ExponentBits]),
      .code_o(known)
  );
  always_comb if (started_q) assert (known == whole);
endmodule

// SPDX-License-Identifier: Apache-2.0
// A 64-bit multiple-input signature register over results, in order: docs/host-link.md, Signature. A result a cycle; it is
// in signature_o two cycles later. Mirrors ResultSignature of golden/packet/signature.hpp.
module result_signature (
    input  logic                           clk_i,
    input  logic                           clear_i,
    input  logic                           in_valid_i,
    input  photonloom_pkg::gather_result_t in_i,
    output logic [63:0]                    signature_o
);
  localparam int unsigned Bits = photonloom_pkg::GatherResultPacketBits;
  localparam int unsigned Parts = (Bits + 63) / 64;

  // The register is linear: after all parts it is what they alone would leave, plus what the old state alone would.
  function automatic logic [63:0] folded(input logic [63:0] state, input logic [64*Parts-1:0] parts);
    folded = state;
    for (int unsigned i = 0; i < Parts; i++)
      folded = {1'b0, folded[63:1]} ^ (folded[0] ? 64'hC96C5795D7870F42 : 64'd0) ^ parts[64*i+:64];
  endfunction

  logic valid_q;
  logic [63:0] parts_q;

  always_ff @(posedge clk_i) begin
    valid_q <= in_valid_i && !clear_i;
    parts_q <= folded('0, (64 * Parts)'(in_i));
    if (valid_q) signature_o <= folded(signature_o, '0) ^ parts_q;
    if (clear_i) signature_o <= '0;
  end
endmodule

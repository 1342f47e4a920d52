// SPDX-License-Identifier: Apache-2.0
// The code of photon_gatherer_key_code, of a key whose exponent was found beforehand: its mantissa is chosen, no more.
// Combinational.
module photon_gatherer_known_code #(
    parameter int unsigned KeyBits = 42,
    parameter int unsigned CodeBits = 20,
    parameter int unsigned ExponentBits = 3
) (
    input  logic [     KeyBits-1:0] key_i,
    input  logic [ExponentBits-1:0] exponent_i,
    output logic [    CodeBits-1:0] code_o
);
  localparam int unsigned MantissaBits = CodeBits - ExponentBits;
  localparam int unsigned Exponents = 1 << ExponentBits;
  localparam int unsigned Step = KeyBits > MantissaBits ? (KeyBits - MantissaBits + Exponents - 2) / (Exponents - 1) : 1;
  localparam int unsigned Width = MantissaBits + Step * (Exponents - 1);  // of all mantissas together, at least KeyBits

  logic [Width-1:0] key;
  assign key = Width'(key_i);
  assign code_o = {exponent_i, MantissaBits'(key >> (Step * 32'(exponent_i)))};
endmodule

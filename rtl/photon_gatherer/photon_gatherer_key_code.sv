// SPDX-License-Identifier: Apache-2.0
// A short code of a number, as a floating-point one: {exponent, mantissa}, exponent e for the mantissa key >> Step * e, the least
// with which that has no more than its bits. Codes are in the order of their keys; keys that differ may have one code.
// Combinational.
module photon_gatherer_key_code #(
    parameter int unsigned KeyBits = 42,
    parameter int unsigned CodeBits = 20,
    parameter int unsigned ExponentBits = 3
) (
    input  logic [ KeyBits-1:0] key_i,
    output logic [CodeBits-1:0] code_o
);
  localparam int unsigned MantissaBits = CodeBits - ExponentBits;
  localparam int unsigned Exponents = 1 << ExponentBits;
  localparam int unsigned Step = KeyBits > MantissaBits ? (KeyBits - MantissaBits + Exponents - 2) / (Exponents - 1) : 1;
  localparam int unsigned Width = MantissaBits + Step * (Exponents - 1);  // of all mantissas together, at least KeyBits

  logic [Width-1:0] key;
  assign key = Width'(key_i);

  always_comb begin
    code_o = {{ExponentBits{1'b1}}, key[Width-1-:MantissaBits]};
    for (int unsigned e = Exponents - 1; e > 0; e--)
      if ((key >> (MantissaBits + Step * (e - 1))) == '0) code_o = {ExponentBits'(e - 1), key[Step*(e-1)+:MantissaBits]};
  end
endmodule

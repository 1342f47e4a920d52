// SPDX-License-Identifier: Apache-2.0
// Splits the number of a 32-bit word in the photon lines into line and word in the line: quotient and remainder by
// LineWords, one bit of the quotient a cycle, or at once where LineWords is a power of two. A word is taken when nothing is
// held; out_valid_o stays until out_taken_i. Latency AddressBits + 1 cycles, for a power of two 1.
module photon_word_address #(
    parameter int unsigned AddressBits = 28,
    parameter int unsigned LineWords = 32,
    localparam int unsigned WordBits = $clog2(LineWords)
) (
    input  logic                   clk_i,
    input  logic                   rst_i,
    input  logic                   in_valid_i,
    output logic                   in_ready_o,
    input  logic [AddressBits-1:0] in_address_i,
    input  logic [           31:0] in_data_i,
    output logic                   out_valid_o,
    input  logic                   out_taken_i,
    output logic [AddressBits-1:0] out_line_o,
    output logic [   WordBits-1:0] out_word_o,
    output logic [           31:0] out_data_o
);
  if (LineWords < 2) begin : gen_bad_words
    a_line_must_hold_two_words_or_more bad_words ();
  end

  logic busy_q;

  assign in_ready_o = !busy_q;
  always_ff @(posedge clk_i) if (in_valid_i && in_ready_o) out_data_o <= in_data_i;

  if ((1 << WordBits) == LineWords) begin : gen_slice
    logic [AddressBits-1:0] address_q;
    always_ff @(posedge clk_i) begin
      if (in_ready_o) address_q <= in_address_i;
      if (in_ready_o) busy_q <= in_valid_i;
      else if (out_taken_i) busy_q <= 1'b0;
      if (rst_i) busy_q <= 1'b0;
    end
    assign out_valid_o = busy_q;
    assign out_line_o = address_q >> WordBits;
    assign out_word_o = address_q[WordBits-1:0];
  end else begin : gen_divide
    localparam int unsigned CountBits = $clog2(AddressBits + 1);
    logic [AddressBits-1:0] quotient_q;  // bits of the address still to come on top, of the quotient below
    logic [WordBits-1:0] remainder_q;
    logic [WordBits:0] next;
    logic fits;
    logic [CountBits-1:0] left_q;

    assign next = {remainder_q, quotient_q[AddressBits-1]};
    assign fits = next >= (WordBits + 1)'(LineWords);
    assign out_valid_o = busy_q && left_q == '0;
    assign out_line_o = quotient_q;
    assign out_word_o = remainder_q;
    always_ff @(posedge clk_i) begin
      if (in_ready_o) begin
        quotient_q <= in_address_i;
        remainder_q <= '0;
        left_q <= CountBits'(AddressBits);
        busy_q <= in_valid_i;
      end else if (left_q != '0) begin
        quotient_q <= {quotient_q[AddressBits-2:0], fits};
        remainder_q <= fits ? WordBits'(next - (WordBits + 1)'(LineWords)) : next[WordBits-1:0];
        left_q <= left_q - 1'b1;
      end else if (out_taken_i) begin
        busy_q <= 1'b0;
      end
      if (rst_i) busy_q <= 1'b0;
    end
  end
endmodule

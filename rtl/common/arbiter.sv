// SPDX-License-Identifier: Apache-2.0
// Several streams into one, in turn: of the inputs that offer a word the first one after the last one served, cyclically,
// so an input that waits is passed over by each other input once at most. After reset input 0 is first. One word a cycle,
// latency 1; out_source_o says which input the word came from.
//
// Which word comes first depends on cycles: only for a port whose replies go back by source and that nobody can see
// otherwise (a memory, a cache), never between packet streams.
//
// A path leads from in_valid_i to in_ready_o (at most one bit of which is 1), none from out_ready_i; out_valid_o, out_o
// and out_source_o come from registers.
module arbiter #(
    parameter int unsigned Inputs = 2,
    parameter int unsigned Width = 8,
    localparam int unsigned SourceBits = Inputs > 1 ? $clog2(Inputs) : 1
) (
    input  logic                    clk_i,
    input  logic                    rst_i,
    input  logic [      Inputs-1:0] in_valid_i,
    output logic [      Inputs-1:0] in_ready_o,
    input  logic [Inputs*Width-1:0] in_i,         // input 0 lowest
    output logic                    out_valid_o,
    input  logic                    out_ready_i,
    output logic [       Width-1:0] out_o,
    output logic [  SourceBits-1:0] out_source_o
);
  if (Inputs < 1) begin : gen_bad_inputs
    arbiter_needs_at_least_1_input bad_inputs ();
  end

  // Inputs above the last one served come before the others.
  logic [Inputs-1:0] above_q, first, any, grant;
  logic ready;

  assign first = in_valid_i & above_q;
  assign any = first != '0 ? first : in_valid_i;
  assign grant = any & (~any + 1'b1);
  assign in_ready_o = ready ? grant : '0;

  logic [Width-1:0] word;
  logic [SourceBits-1:0] source;
  always_comb begin
    word   = '0;
    source = '0;
    for (int unsigned i = 0; i < Inputs; i++) begin
      if (grant[i]) word = word | in_i[Width*i+:Width];
      if (grant[i]) source = source | SourceBits'(i);
    end
  end

  skid_buffer #(
      .Width(SourceBits + Width)
  ) outgoing (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(in_valid_i != '0),
      .in_ready_o(ready),
      .in_i({source, word}),
      .out_valid_o(out_valid_o),
      .out_ready_i(out_ready_i),
      .out_o({out_source_o, out_o})
  );

  always_ff @(posedge clk_i) begin
    if (ready && in_valid_i != '0) above_q <= ~(grant | (grant - 1'b1));
    if (rst_i) above_q <= '1;
  end
endmodule

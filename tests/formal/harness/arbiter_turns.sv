// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/skid_buffer.sv rtl/common/arbiter.sv
// arbiter: what comes out of it from one input is what that input gave, in order, nothing lost or doubled; nobody is
// passed over twice by the same input; what is offered is held. Three inputs of one freely chosen bit each.
module arbiter_turns (
    input logic       clk_i,
    input logic       rst_i,
    input logic [2:0] in_valid_i,
    input logic [2:0] in_i,
    input logic       out_ready_i
);
  logic [2:0] in_ready;
  logic out_valid, out;
  logic [1:0] out_source;

  arbiter #(
      .Inputs(3),
      .Width(1)
  ) dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(in_valid_i),
      .in_ready_o(in_ready),
      .in_i(in_i),
      .out_valid_o(out_valid),
      .out_ready_i(out_ready_i),
      .out_o(out),
      .out_source_o(out_source)
  );

  logic started_q = 1'b0;
  always_ff @(posedge clk_i) started_q <= 1'b1;
  always_comb assume (rst_i == !started_q);

  // One input, any, is watched, another one rivals it.
  (* anyconst *) logic [1:0] watched, rival;
  always_comb assume (watched < 2'd3 && rival < 2'd3 && rival != watched);

  // Its words that are under way, the oldest lowest; the buffer behind the arbiter holds two.
  logic [2:0] words_q = '0;
  logic [1:0] held_q = '0;
  logic passed_q = 1'b0, waiting_q = 1'b0, word_q = 1'b0, stalled_q = 1'b0;
  logic [2:0] shown_q = '0;
  logic push, pop;
  assign push = in_valid_i[watched] && in_ready[watched];
  assign pop  = out_valid && out_ready_i && out_source == watched;

  always_ff @(posedge clk_i) begin
    if (!rst_i) begin
      held_q <= held_q + 2'(push) - 2'(pop);
      if (pop) words_q <= words_q >> 1;
      if (push) words_q[held_q-2'(pop)] <= in_i[watched];

      passed_q <= in_valid_i[watched] && !push && (passed_q || (in_valid_i[rival] && in_ready[rival]));
      waiting_q <= in_valid_i[watched] && !push;
      word_q <= in_i[watched];
      stalled_q <= out_valid && !out_ready_i;
      shown_q <= {out_source, out};
    end
  end

  // Streams offer a word until it is taken.
  always_comb begin
    if (waiting_q) assume (in_valid_i[watched] && in_i[watched] == word_q);
  end

  always_comb begin
    if (started_q) begin
      assert ((in_ready & (in_ready - 3'd1)) == 3'd0);
      assert ((in_ready & ~in_valid_i) == 3'd0);
      assert (held_q <= 2'd2);
      if (pop) assert (held_q != 2'd0 && out == words_q[0]);
      if (out_valid) assert (out_source < 2'd3);
      if (stalled_q) assert (out_valid && {out_source, out} == shown_q);
      // Passed over by the rival once: not again.
      if (passed_q) assert (!(in_valid_i[rival] && in_ready[rival]));
    end
  end
endmodule

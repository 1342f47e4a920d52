// SPDX-License-Identifier: Apache-2.0
// The laws of a module that words of a stream go through, each where its parameter is 1; a word is one bit.
//
// Order: what goes in comes out; nothing is lost, doubled, changed, added or overtaken. The environment sends 1 in two words
// on end, which it chooses freely, and 0 in all others. A module that does not look at its words keeps all of them in order
// iff these two are always seen on end again, once: to lose, double or move a word breaks the pair that it belongs to.
// Law: valid stays and the word holds until it is taken.
// Progress: a word that went in is offered, and one that is offered is accepted, within Limit cycles in which the
// consumer is ready.
module stream_checks #(
    parameter int unsigned Order = 1,
    parameter int unsigned Law = 1,
    parameter int unsigned Progress = 1,
    parameter int unsigned Limit = 4
) (
    input logic clk_i,
    input logic rst_i,
    input logic in_valid_i,
    input logic in_ready_i,
    input logic in_i,
    input logic out_valid_i,
    input logic out_ready_i,
    input logic out_i
);
  logic sent, taken;
  logic [1:0] sent_q, taken_q;  // words 1 so far
  assign sent  = in_valid_i && in_ready_i;
  assign taken = out_valid_i && out_ready_i;

  always_ff @(posedge clk_i) begin
    if (sent && in_i) sent_q <= sent_q + 1'b1;
    if (taken && out_i) taken_q <= taken_q + 1'b1;
    if (rst_i) begin
      sent_q  <= '0;
      taken_q <= '0;
    end
  end

  always_comb begin
    if (!rst_i && in_valid_i) begin
      if (sent_q == 2'd1) assume (in_i);
      if (sent_q == 2'd2) assume (!in_i);
    end
  end

  if (Order == 1) begin : gen_order
    always_comb begin
      if (!rst_i && taken) begin
        if (taken_q == 2'd1) assert (out_i);
        if (taken_q == 2'd2) assert (!out_i);
      end
    end
  end

  if (Law == 1) begin : gen_law
    logic stalled_q, shown_q;
    always_ff @(posedge clk_i) begin
      stalled_q <= !rst_i && out_valid_i && !out_ready_i;
      shown_q   <= out_i;
    end
    always_comb begin
      if (!rst_i && stalled_q) assert (out_valid_i && out_i == shown_q);
    end
  end

  if (Progress == 1) begin : gen_progress
    localparam int unsigned Bits = $clog2(Limit + 2);
    logic [Bits-1:0] inside_q, refused_q;
    always_ff @(posedge clk_i) begin
      if (out_ready_i) inside_q <= inside_q + 1'b1;
      if (sent_q == taken_q || (taken && out_i)) inside_q <= '0;
      if (out_ready_i) refused_q <= refused_q + 1'b1;
      if (!in_valid_i || in_ready_i) refused_q <= '0;
      if (rst_i) begin
        inside_q  <= '0;
        refused_q <= '0;
      end
    end
    always_comb begin
      if (!rst_i) assert (inside_q <= Bits'(Limit) && refused_q <= Bits'(Limit));
    end
  end
endmodule

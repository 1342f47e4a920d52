// SPDX-License-Identifier: Apache-2.0
// Queries that are done, until a sum takes them: those of its contexts in the order of their ends, but for those of two
// trees, of which the lower tree's go first. A query is done in a tree, or else in an empty map, which the tree of its
// context then waits for: no two of one tree end in a cycle.
//
// One of each tree in a cycle, one to each sum; latency 1. The queues hold every context, so none is refused.
module photon_gatherer_ends #(
    parameter int unsigned Contexts = 16,
    parameter int unsigned Trees = 1,  // number n of N trees and sums has the contexts c with c % N = n, as c / N
    parameter int unsigned Sums = 1,
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned TreeContexts = (Contexts + Trees - 1) / Trees,
    localparam int unsigned TreeContextBits = TreeContexts > 1 ? $clog2(TreeContexts) : 1,
    localparam int unsigned SumContexts = (Contexts + Sums - 1) / Sums,
    localparam int unsigned SumContextBits = SumContexts > 1 ? $clog2(SumContexts) : 1
) (
    input  logic                             clk_i,
    input  logic                             rst_i,
    // a query is done: in a tree, or else in an empty map
    input  logic [                Trees-1:0] tree_done_i,
    input  logic [Trees*TreeContextBits-1:0] tree_done_context_i,
    input  logic                             empty_done_i,
    input  logic [          ContextBits-1:0] empty_done_context_i,
    // in either, of each tree, in the same cycle
    output logic [                Trees-1:0] done_o,
    output logic [Trees*TreeContextBits-1:0] done_context_o,
    // the next one of each sum
    output logic [                 Sums-1:0] out_valid_o,
    input  logic [                 Sums-1:0] out_ready_i,
    output logic [  Sums*SumContextBits-1:0] out_context_o,
    output logic [                 Sums-1:0] out_empty_o             // in an empty map
);
  // A queue holds the ends of one tree that go to one sum, so that each has one side at each end.
  localparam int unsigned Queues = Trees > Sums ? Trees : Sums;
  localparam int unsigned EndContexts = (Contexts + Queues - 1) / Queues;
  localparam int unsigned EndDepth = EndContexts > 2 ? (1 << $clog2(EndContexts)) : 2;
  localparam int unsigned EndBits = SumContextBits + 1;  // in an empty map
  logic [Queues-1:0] waiting, taken;
  logic [Queues*EndBits-1:0] oldest;

  for (genvar tree = 0; tree < Trees; tree++) begin : gen_done
    assign done_o[tree] = tree_done_i[tree] || (empty_done_i && (32'(empty_done_context_i) & (Trees - 1)) == tree);
    assign done_context_o[TreeContextBits*tree+:TreeContextBits] =
        tree_done_i[tree] ? tree_done_context_i[TreeContextBits*tree+:TreeContextBits] :
        TreeContextBits'(empty_done_context_i >> $clog2(Trees));
  end

  for (genvar q = 0; q < Queues; q++) begin : gen_queue
    localparam int unsigned Tree = q % Trees;
    logic [ContextBits-1:0] context_done;
    /* verilator lint_off UNUSEDSIGNAL */  // the queue holds every context
    logic ready;
    /* verilator lint_on UNUSEDSIGNAL */
    assign context_done = ContextBits'(32'(done_context_o[TreeContextBits*Tree+:TreeContextBits]) * Trees + Tree);
    fifo #(
        .Width(EndBits),
        .Depth(EndDepth)
    ) ends (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .in_valid_i(done_o[Tree] && (32'(context_done) & (Queues - 1)) == q),
        .in_ready_o(ready),
        .in_i({SumContextBits'(context_done >> $clog2(Sums)), !tree_done_i[Tree]}),
        .out_valid_o(waiting[q]),
        .out_ready_i(taken[q]),
        .out_o(oldest[EndBits*q+:EndBits])
    );
  end

  for (genvar s = 0; s < Sums; s++) begin : gen_sum
    // The first queue of the sum's in which one waits.
    always_comb begin
      out_valid_o[s] = 1'b0;
      {out_context_o[SumContextBits*s+:SumContextBits], out_empty_o[s]} = oldest[EndBits*s+:EndBits];
      for (int unsigned q = Queues; q > 0; q--) begin
        if (((q - 1) & (Sums - 1)) == s && waiting[q-1]) begin
          out_valid_o[s] = 1'b1;
          {out_context_o[SumContextBits*s+:SumContextBits], out_empty_o[s]} = oldest[EndBits*(q-1)+:EndBits];
        end
      end
    end
    for (genvar q = s; q < Queues; q = q + Sums) begin : gen_taken
      logic [Queues-1:0] before_it;
      for (genvar other = 0; other < Queues; other++) begin : gen_before
        assign before_it[other] = other < q && other % Sums == s && waiting[other];
      end
      assign taken[q] = out_ready_i[s] && before_it == '0;
    end
  end
endmodule

// SPDX-License-Identifier: Apache-2.0
// Which contexts met a word of memory that was not right since their queries started, and how many such words there were.
// A context's bit is set four cycles after the word came at the latest, well before the query that asked for it can be done.
// Without photonloom_pkg::Parity there are none, and no logic.
module photon_gatherer_faults #(
    parameter int unsigned Contexts = 16,
    parameter int unsigned Trees = 1,  // tree t has the contexts c with c % Trees = t, as c / Trees
    parameter int unsigned Sums = 1,   // sum s has the contexts c with c % Sums = s, as c / Sums
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned TreeContexts = (Contexts + Trees - 1) / Trees,
    localparam int unsigned TreeContextBits = TreeContexts > 1 ? $clog2(TreeContexts) : 1,
    localparam int unsigned SumContexts = (Contexts + Sums - 1) / Sums,
    localparam int unsigned SumContextBits = SumContexts > 1 ? $clog2(SumContexts) : 1
) (
    input  logic                             clk_i,
    input  logic                             rst_i,
    // a query starts in a context
    input  logic                             start_i,
    input  logic [          ContextBits-1:0] start_context_i,
    // a word is not right: a node's of each tree, one of a line, a tag of the cache, which harms no query
    input  logic [                Trees-1:0] node_i,
    input  logic [Trees*TreeContextBits-1:0] node_context_i,
    input  logic                             line_i,
    input  logic [          ContextBits-1:0] line_context_i,
    input  logic                             tag_i,
    // whether a context met one, for each sum
    input  logic [  Sums*SumContextBits-1:0] found_context_i,
    output logic [                 Sums-1:0] found_faulty_o,
    output logic [                     31:0] count_o
);
  if (photonloom_pkg::Parity != 0) begin : gen_faults
    localparam int unsigned StepBits = $clog2(Trees + 3);
    logic [(1<<ContextBits)-1:0] faulty_q;
    logic [StepBits-1:0] step, step_q;

    always_comb begin
      step = StepBits'(line_i) + StepBits'(tag_i);
      for (int unsigned t = 0; t < Trees; t++) step = step + StepBits'(node_i[t]);
      for (int unsigned s = 0; s < Sums; s++)
        found_faulty_o[s] = faulty_q[ContextBits'(32'(found_context_i[SumContextBits*s+:SumContextBits])*Sums+s)];
    end

    always_ff @(posedge clk_i) begin
      if (start_i) faulty_q[start_context_i] <= 1'b0;
      if (line_i) faulty_q[line_context_i] <= 1'b1;
      for (int unsigned t = 0; t < Trees; t++)
        if (node_i[t])
          faulty_q[ContextBits'(32'(node_context_i[TreeContextBits*t+:TreeContextBits])*Trees+t)] <= 1'b1;
      step_q <= step;
      count_o <= count_o + 32'(step_q);
      if (rst_i) begin
        step_q <= '0;
        count_o <= '0;
      end
    end
  end else begin : gen_none
    /* verilator lint_off UNUSEDSIGNAL */
    logic unused;
    /* verilator lint_on UNUSEDSIGNAL */
    assign unused = &{
      1'b0, clk_i, rst_i, start_i, start_context_i, node_i, node_context_i, line_i, line_context_i, tag_i, found_context_i
    };
    assign found_faulty_o = '0;
    assign count_o = '0;
  end
endmodule

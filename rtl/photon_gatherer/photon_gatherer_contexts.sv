// SPDX-License-Identifier: Apache-2.0
// Which contexts are free. A query takes one when it starts. It is free again when its loads have been read for the sum
// and, where the query wants its photons, for those too. What a context holds lies beside what reads it.
//
// What is free is known a cycle late, so takes are at least two cycles apart. The lowest free context is the next. With
// GroupsFirst the lowest of each four is a register, and of these the next a cycle later: takes are at least three cycles apart.
module photon_gatherer_contexts #(
    parameter int unsigned Contexts = 16,
    parameter int unsigned Sums = 1,  // sum s has the contexts c with c % Sums = s, as c / Sums
    parameter bit GroupsFirst = 1'b0,
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned SumContexts = (Contexts + Sums - 1) / Sums,
    localparam int unsigned SumContextBits = SumContexts > 1 ? $clog2(SumContexts) : 1
) (
    input  logic                           clk_i,
    input  logic                           rst_i,
    output logic                           free_o,
    output logic [        ContextBits-1:0] context_o,
    // a query takes context_o
    input  logic                           take_i,
    input  logic                           take_photons_i,          // it wants its photons
    // nothing more is read for the sum, for the photons
    input  logic [               Sums-1:0] sum_free_i,
    input  logic [Sums*SumContextBits-1:0] sum_free_context_i,
    input  logic                           photons_free_i,
    input  logic [        ContextBits-1:0] photons_free_context_i,
    // one is in use
    output logic                           busy_o
);
  logic [Contexts-1:0] summing_q, streaming_q;
  logic [ContextBits-1:0] context_q;
  /* verilator lint_off UNDRIVEN */
  /* verilator lint_off UNUSEDSIGNAL */
  logic [ContextBits-1:0] context_later_q;  // where GroupsFirst
  /* verilator lint_on UNUSEDSIGNAL */
  /* verilator lint_on UNDRIVEN */

  assign context_o = GroupsFirst ? context_later_q : context_q;
  if (GroupsFirst) begin : gen_groups
    localparam int unsigned Groups = (Contexts + 3) / 4;
    logic [Groups-1:0] some_q;
    logic [1:0] first_q[0:Groups-1];
    always_ff @(posedge clk_i) begin
      some_q <= '0;
      for (int unsigned c = Contexts; c > 0; c--)
        if (!summing_q[c-1] && !streaming_q[c-1]) begin
          some_q[(c-1)/4]  <= 1'b1;
          first_q[(c-1)/4] <= 2'(c - 1);
        end
      for (int unsigned g = Groups; g > 0; g--) if (some_q[g-1]) context_later_q <= ContextBits'(4 * (g - 1)) | ContextBits'(first_q[g-1]);
    end
  end

  assign busy_o = (summing_q | streaming_q) != '0;

  always_ff @(posedge clk_i) begin
    free_o <= (summing_q | streaming_q) != '1;
    for (int unsigned c = Contexts; c > 0; c--)
      if (!summing_q[c-1] && !streaming_q[c-1]) context_q <= ContextBits'(c - 1);
    for (int unsigned c = 0; c < Contexts; c++) begin
      if (take_i && context_o == ContextBits'(c)) begin
        summing_q[c] <= 1'b1;
        streaming_q[c] <= take_photons_i;
      end
      if (sum_free_i[c%Sums] && sum_free_context_i[SumContextBits*(c%Sums)+:SumContextBits] == SumContextBits'(c / Sums))
        summing_q[c] <= 1'b0;
      if (photons_free_i && photons_free_context_i == ContextBits'(c)) streaming_q[c] <= 1'b0;
    end
    if (rst_i) begin
      summing_q <= '0;
      streaming_q <= '0;
    end
  end
endmodule

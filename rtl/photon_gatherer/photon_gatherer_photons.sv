// SPDX-License-Identifier: Apache-2.0
// The photons of queries that want them, in the order of those queries and in (d2, index) order within each. Waits for
// the oldest such query to finish, takes a snapshot of its list's places (a token through the candidates' pipeline),
// reads them from the slot store whenever the sum does not, and gives the context free. One photon in three cycles, with WordLater in four.
module photon_gatherer_photons #(
    parameter int unsigned K = 16,
    parameter int unsigned Contexts = 16,
    parameter int unsigned Trees = 1,  // tree t has the contexts c with c % Trees = t, as c / Trees
    parameter bit Wide = 1'b0,  // of several trees and lists
    parameter bit MoveLater = 1'b0,  // the next photon is known a cycle after one is read: whether it is, is late
    parameter bit WordLater = 1'b0,  // a word of the slot store comes a cycle later
    parameter int unsigned StoreBits = 98,
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned TreeContexts = (Contexts + Trees - 1) / Trees,
    localparam int unsigned TreeContextBits = TreeContexts > 1 ? $clog2(TreeContexts) : 1,
    localparam int unsigned PlaceBits = K > 1 ? $clog2(K) : 1,
    localparam int unsigned CountBits = $clog2(K + 1)
) (
    input  logic                             clk_i,
    input  logic                             rst_i,
    // queries that want photons, in order
    input  logic                             start_i,
    input  logic [          ContextBits-1:0] start_context_i,
    // a query finished (of any kind), one of each tree's
    input  logic [                Trees-1:0] done_i,
    input  logic [Trees*TreeContextBits-1:0] done_context_i,
    // snapshot
    output logic                             snapshot_valid_o,
    input  logic                             snapshot_ready_i,
    output logic [          ContextBits-1:0] snapshot_context_o,
    input  logic                             snapshot_i,
    input  logic [            CountBits-1:0] snapshot_count_i,
    input  logic [          K*PlaceBits-1:0] snapshot_places_i,
    // slot store: data a cycle after the address, with WordLater two
    output logic                             read_valid_o,
    input  logic                             read_ready_i,
    output logic [          ContextBits-1:0] read_context_o,
    output logic [            PlaceBits-1:0] read_place_o,
    input  logic [            StoreBits-1:0] read_data_i,
    // context free
    output logic                             free_o,
    output logic [          ContextBits-1:0] free_context_o,
    // photons
    output logic                             out_valid_o,
    input  logic                             out_ready_i,
    output logic [            StoreBits-1:0] out_data_o,
    output logic                             out_last_o
);
  localparam int unsigned OrderDepth = Contexts > 2 ? (1 << $clog2(Contexts)) : 2;
  localparam logic [1:0] Idle = 2'd0, Ask = 2'd1, Wait = 2'd2, Stream = 2'd3;

  logic [1:0] state_q;
  logic [Contexts-1:0] done_q;
  /* verilator lint_off UNDRIVEN */
  /* verilator lint_off UNUSEDSIGNAL */
  logic head_done;  // where Wide
  /* verilator lint_on UNUSEDSIGNAL */
  /* verilator lint_on UNDRIVEN */
  logic head_valid, head_taken, read, last, read_1_q, full_q, comes;
  logic moved;  // a photon that was read is left behind
  logic [ContextBits-1:0] head, context_out;
  logic [CountBits-1:0] left_q;
  logic [K*PlaceBits-1:0] places_q;
  /* verilator lint_off UNUSEDSIGNAL */  // the FIFO holds all that can come
  logic order_ready;
  /* verilator lint_on UNUSEDSIGNAL */

  fifo #(
      .Width(ContextBits),
      .Depth(OrderDepth)
  ) order (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(start_i),
      .in_ready_o(order_ready),
      .in_i(start_context_i),
      .out_valid_o(head_valid),
      .out_ready_i(head_taken),
      .out_o(head)
  );

  assign snapshot_valid_o = state_q == Ask;
  assign snapshot_context_o = context_out;
  assign read_valid_o = state_q == Stream && left_q != '0 && !full_q;
  assign read_context_o = context_out;
  assign read_place_o = places_q[0+:PlaceBits];
  assign read = read_valid_o && read_ready_i;
  assign last = left_q == CountBits'(1);
  assign moved = MoveLater ? read_1_q : read;
  if (WordLater) begin : gen_comes_later
    logic read_2_q;
    always_ff @(posedge clk_i) read_2_q <= read_1_q && !rst_i;
    assign comes = read_2_q;
  end else begin : gen_comes
    assign comes = read_1_q;
  end
  assign head_taken = state_q == Stream && (left_q == '0 || (moved && last));

  // The context whose photons leave. Of several trees the contexts are many and the ways to what holds them are long: they
  // begin at a register instead of the queue's memory, and the context is free a cycle later.
  if (Trees > 1) begin : gen_registers
    logic [ContextBits-1:0] context_q;
    always_ff @(posedge clk_i) begin
      if (state_q == Idle) context_q <= head;
      free_o <= head_taken && !rst_i;
      free_context_o <= context_q;
    end
    assign context_out = context_q;
    if (Wide) begin : gen_known
      // Looked up from there, a cycle later.
      logic known_q;
      always_ff @(posedge clk_i) known_q <= state_q == Idle && head_valid && !rst_i;
      assign head_done = known_q && done_q[context_q];
    end
  end else begin : gen_queue
    assign context_out = head;
    assign free_o = head_taken;
    assign free_context_o = head;
  end

  always_ff @(posedge clk_i) begin
    unique case (state_q)
      Idle: if (Wide ? head_done : head_valid && done_q[head]) state_q <= Ask;
      Ask: if (snapshot_ready_i) state_q <= Wait;
      Wait: if (snapshot_i) state_q <= Stream;
      default: if (head_taken) state_q <= Idle;
    endcase
    if (snapshot_i) begin
      left_q <= snapshot_count_i;
      places_q <= snapshot_places_i;
    end else if (moved) begin
      left_q <= left_q - 1'b1;
      places_q <= places_q >> PlaceBits;
    end
    for (int unsigned c = 0; c < Contexts; c++) begin
      if (start_i && start_context_i == ContextBits'(c)) done_q[c] <= 1'b0;
      if (done_i[c%Trees] && done_context_i[TreeContextBits*(c%Trees)+:TreeContextBits] == TreeContextBits'(c / Trees))
        done_q[c] <= 1'b1;
    end

    // One photon is on its way to the output or there.
    if (read) full_q <= 1'b1;
    else if (out_valid_o && out_ready_i) full_q <= 1'b0;
    read_1_q <= read;
    if (comes) out_data_o <= read_data_i;
    if (moved) out_last_o <= last;
    if (comes) out_valid_o <= 1'b1;
    else if (out_ready_i) out_valid_o <= 1'b0;
    if (rst_i) begin
      state_q <= Idle;
      read_1_q <= 1'b0;
      full_q <= 1'b0;
      out_valid_o <= 1'b0;
    end
  end
endmodule

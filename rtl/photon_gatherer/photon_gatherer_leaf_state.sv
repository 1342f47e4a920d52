// SPDX-License-Identifier: Apache-2.0
// What is kept of a query while its leaf is searched, written when the leaf is reached and read when it is done:
//
//   leaf reached | add to the query's leaves and inner nodes | write them, the stack pointer, and whether it is the last
//   leaf done: with a candidate, or without one | queue | read | register | to the stack
//
// One leaf in and one out a cycle; what is kept can be read 3 cycles after the leaf is reached, and an end is at the stack
// 2 cycles after it came. With its last token the stack reads the bound 5 cycles later or more, when it is there: done_i,
// the queue, the register behind it, two stages of the stack. Mirrors the counts and the leaf limit of search_gather in
// golden/unit/photon_gatherer.cpp.
module photon_gatherer_leaf_state #(
    parameter int unsigned Contexts = 16,
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned LineBits = photonloom_pkg::LineBits,
    localparam int unsigned NodeBits = LineBits + 1,
    localparam int unsigned StackBits = $clog2(LineBits + 1)
) (
    input  logic                   clk_i,
    input  logic                   rst_i,
    // a leaf is reached
    input  logic                   leaf_valid_i,
    input  logic [ContextBits-1:0] leaf_context_i,
    input  logic                   leaf_first_i,      // of its query
    input  logic [   LineBits-1:0] leaf_line_i,
    input  logic [  StackBits-1:0] leaf_stack_i,
    input  logic [  StackBits-1:0] leaf_steps_i,      // inner nodes on the way to it
    // the line of a context's leaf
    input  logic [ContextBits-1:0] line_context_i,
    output logic [   LineBits-1:0] line_o,
    // a leaf is done: its last token has gone, or it has none
    input  logic                   done_i,
    input  logic [ContextBits-1:0] done_context_i,
    input  logic                   empty_i,
    input  logic [ContextBits-1:0] empty_context_i,
    // to the stack
    output logic                   finish_valid_o,
    input  logic                   finish_ready_i,
    output logic [ContextBits-1:0] finish_context_o,
    output logic [  StackBits-1:0] finish_stack_o,
    output logic                   finish_stop_o,     // the leaf limit is reached
    // counts of a context
    input  logic [ContextBits-1:0] counts_context_i,
    output logic [   NodeBits-1:0] leaves_o,
    output logic [   NodeBits-1:0] nodes_o,
    // counted event
    output logic                   leaf_o
);
  localparam int unsigned QueueDepth = Contexts > 2 ? (1 << $clog2(Contexts)) : 2;

  // ---- a leaf is reached: register | count | write the counts ----
  logic leaf_valid_q, leaf_first_q, counted_valid_q, leaf_stop;
  logic [ContextBits-1:0] leaf_context_q, counted_context_q;
  logic [LineBits-1:0] leaf_line_q;
  logic [StackBits-1:0] leaf_stack_q, leaf_steps_q, counted_stack_q, counted_steps_q;
  logic [NodeBits-1:0] leaves_stored, nodes_stored, leaves_q, nodes_q, leaves_next, nodes_next;

  always_ff @(posedge clk_i) begin
    leaf_valid_q <= leaf_valid_i;
    leaf_context_q <= leaf_context_i;
    leaf_first_q <= leaf_first_i;
    leaf_line_q <= leaf_line_i;
    leaf_stack_q <= leaf_stack_i;
    leaf_steps_q <= leaf_steps_i;
    counted_valid_q <= leaf_valid_q;
    counted_context_q <= leaf_context_q;
    counted_stack_q <= leaf_stack_q;
    counted_steps_q <= leaf_steps_q;
    leaves_q <= leaf_first_q ? '0 : leaves_stored;
    nodes_q <= leaf_first_q ? '0 : nodes_stored;
    if (rst_i) begin
      leaf_valid_q <= 1'b0;
      counted_valid_q <= 1'b0;
    end
  end

  assign leaf_o = leaf_valid_q;
  assign leaves_next = leaves_q + 1'b1;
  assign nodes_next = nodes_q + NodeBits'(counted_steps_q);
  assign leaf_stop = photonloom_pkg::LeafLimit != 0 && 32'(leaves_next) == photonloom_pkg::LeafLimit;

  lut_ram #(
      .Width(2 * NodeBits),
      .Depth(Contexts)
  ) counts_to_step (
      .clk_i(clk_i),
      .write_i(counted_valid_q),
      .write_address_i(counted_context_q),
      .write_data_i({leaves_next, nodes_next}),
      .read_address_i(leaf_context_q),
      .read_data_o({leaves_stored, nodes_stored})
  );
  lut_ram #(
      .Width(2 * NodeBits),
      .Depth(Contexts)
  ) counts_to_read (
      .clk_i(clk_i),
      .write_i(counted_valid_q),
      .write_address_i(counted_context_q),
      .write_data_i({leaves_next, nodes_next}),
      .read_address_i(counts_context_i),
      .read_data_o({leaves_o, nodes_o})
  );
  lut_ram #(
      .Width(LineBits),
      .Depth(Contexts)
  ) lines_in_hand (
      .clk_i(clk_i),
      .write_i(leaf_valid_q),
      .write_address_i(leaf_context_q),
      .write_data_i(leaf_line_q),
      .read_address_i(line_context_i),
      .read_data_o(line_o)
  );

  // ---- a leaf is done ----
  logic finish_waiting, finish_free, empty_waiting, oldest_stop;
  logic [ContextBits-1:0] finish_oldest, empty_oldest, oldest_context;
  logic [StackBits-1:0] oldest_stack;
  /* verilator lint_off UNUSEDSIGNAL */  // queues hold every context
  logic finish_ready, empty_ready;
  /* verilator lint_on UNUSEDSIGNAL */

  fifo #(
      .Width(ContextBits),
      .Depth(QueueDepth)
  ) finish_queue (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(done_i),
      .in_ready_o(finish_ready),
      .in_i(done_context_i),
      .out_valid_o(finish_waiting),
      .out_ready_i(finish_free),
      .out_o(finish_oldest)
  );
  fifo #(
      .Width(ContextBits),
      .Depth(QueueDepth)
  ) empty_queue (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(empty_i),
      .in_ready_o(empty_ready),
      .in_i(empty_context_i),
      .out_valid_o(empty_waiting),
      .out_ready_i(finish_free && !finish_waiting),
      .out_o(empty_oldest)
  );
  assign finish_free = !finish_valid_o || finish_ready_i;
  assign oldest_context = finish_waiting ? finish_oldest : empty_oldest;

  lut_ram #(
      .Width(StackBits + 1),
      .Depth(Contexts)
  ) stack_pointers (
      .clk_i(clk_i),
      .write_i(counted_valid_q),
      .write_address_i(counted_context_q),
      .write_data_i({leaf_stop, counted_stack_q}),
      .read_address_i(oldest_context),
      .read_data_o({oldest_stop, oldest_stack})
  );

  always_ff @(posedge clk_i) begin
    if (finish_free) begin
      finish_valid_o <= finish_waiting || empty_waiting;
      finish_context_o <= oldest_context;
      finish_stop_o <= oldest_stop;
      finish_stack_o <= oldest_stack;
    end
    if (rst_i) finish_valid_o <= 1'b0;
  end
endmodule

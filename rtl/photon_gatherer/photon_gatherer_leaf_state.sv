// SPDX-License-Identifier: Apache-2.0
// What is kept of a query while its leaf is searched, written when the leaf is reached and read when it is done:
//
//   leaf reached | add to the query's leaves and inner nodes | write them, the stack pointer, and whether it is the last
//   leaf done: with a candidate, or without one | queue | read | register | to the stack
//
// Trees, lists and sums each have their part of the contexts: number n of N has the contexts c with c % N = n, as c /
// N. One leaf in a cycle, one out to each tree; what is kept can be read 3 cycles after the leaf is reached, and an
// end is at the stack 2 cycles after it came. With its last token the stack reads the bound 5 cycles later or more,
// when it is there: done_i, the queue, the register behind it, two stages of the stack. Mirrors the counts and the
// leaf limit of search_gather in golden/unit/photon_gatherer.cpp.
module photon_gatherer_leaf_state #(
    parameter int unsigned Contexts = 16,
    parameter int unsigned Trees = 1,
    parameter int unsigned Lists = 1,
    parameter int unsigned Sums = 1,
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned TreeContexts = (Contexts + Trees - 1) / Trees,
    localparam int unsigned TreeContextBits = TreeContexts > 1 ? $clog2(TreeContexts) : 1,
    localparam int unsigned ListContexts = (Contexts + Lists - 1) / Lists,
    localparam int unsigned ListContextBits = ListContexts > 1 ? $clog2(ListContexts) : 1,
    localparam int unsigned SumContexts = (Contexts + Sums - 1) / Sums,
    localparam int unsigned SumContextBits = SumContexts > 1 ? $clog2(SumContexts) : 1,
    localparam int unsigned LineBits = photonloom_pkg::LineBits,
    localparam int unsigned NodeBits = LineBits + 1,
    localparam int unsigned StackBits = $clog2(LineBits + 1)
) (
    input  logic                             clk_i,
    input  logic                             rst_i,
    // a leaf is reached
    input  logic                             leaf_valid_i,
    input  logic [          ContextBits-1:0] leaf_context_i,
    input  logic                             leaf_first_i,      // of its query
    input  logic [             LineBits-1:0] leaf_line_i,
    input  logic [            StackBits-1:0] leaf_stack_i,
    input  logic [            StackBits-1:0] leaf_steps_i,      // inner nodes on the way to it
    // the line of a context's leaf, for each list
    input  logic [Lists*ListContextBits-1:0] line_context_i,
    output logic [       Lists*LineBits-1:0] line_o,
    // a leaf is done: its last token has gone through its list, or it has none
    input  logic [                Lists-1:0] done_i,
    input  logic [Lists*ListContextBits-1:0] done_context_i,
    input  logic                             empty_i,
    input  logic [          ContextBits-1:0] empty_context_i,
    // to the stack of each tree
    output logic [                Trees-1:0] finish_valid_o,
    input  logic [                Trees-1:0] finish_ready_i,
    output logic [Trees*TreeContextBits-1:0] finish_context_o,
    output logic [      Trees*StackBits-1:0] finish_stack_o,
    output logic [                Trees-1:0] finish_stop_o,     // the leaf limit is reached
    // counts of a context, for each sum
    input  logic [  Sums*SumContextBits-1:0] counts_context_i,
    output logic [        Sums*NodeBits-1:0] leaves_o,
    output logic [        Sums*NodeBits-1:0] nodes_o,
    // counted event
    output logic                             leaf_o
);
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
  for (genvar sum = 0; sum < Sums; sum++) begin : gen_sum
    lut_ram #(
        .Width(2 * NodeBits),
        .Depth(SumContexts)
    ) counts_to_read (
        .clk_i(clk_i),
        .write_i(counted_valid_q && (32'(counted_context_q) & (Sums - 1)) == sum),
        .write_address_i(SumContextBits'(counted_context_q >> $clog2(Sums))),
        .write_data_i({leaves_next, nodes_next}),
        .read_address_i(counts_context_i[SumContextBits*sum+:SumContextBits]),
        .read_data_o({leaves_o[NodeBits*sum+:NodeBits], nodes_o[NodeBits*sum+:NodeBits]})
    );
  end
  for (genvar l = 0; l < Lists; l++) begin : gen_list
    lut_ram #(
        .Width(LineBits),
        .Depth(ListContexts)
    ) lines_in_hand (
        .clk_i(clk_i),
        .write_i(leaf_valid_q && (32'(leaf_context_q) & (Lists - 1)) == l),
        .write_address_i(ListContextBits'(leaf_context_q >> $clog2(Lists))),
        .write_data_i(leaf_line_q),
        .read_address_i(line_context_i[ListContextBits*l+:ListContextBits]),
        .read_data_o(line_o[LineBits*l+:LineBits])
    );
  end

  // ---- leaves are done ----
  // A queue holds the ends of one list that go to one tree, so that each has one side at each end.
  localparam int unsigned Queues = Trees > Lists ? Trees : Lists;
  localparam int unsigned QueueContexts = (Contexts + Queues - 1) / Queues;
  localparam int unsigned QueueDepth = QueueContexts > 2 ? (1 << $clog2(QueueContexts)) : 2;
  localparam int unsigned EmptyDepth = TreeContexts > 2 ? (1 << $clog2(TreeContexts)) : 2;
  logic [Queues-1:0] waiting, taken;
  logic [Queues*TreeContextBits-1:0] oldest;

  for (genvar q = 0; q < Queues; q++) begin : gen_queue
    localparam int unsigned List = q % Lists;
    logic [ContextBits-1:0] context_done;
    /* verilator lint_off UNUSEDSIGNAL */  // the queue holds every context
    logic ready;
    /* verilator lint_on UNUSEDSIGNAL */
    assign context_done = ContextBits'(32'(done_context_i[ListContextBits*List+:ListContextBits]) * Lists + List);
    fifo #(
        .Width(TreeContextBits),
        .Depth(QueueDepth)
    ) ends (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .in_valid_i(done_i[List] && (32'(context_done) & (Queues - 1)) == q),
        .in_ready_o(ready),
        .in_i(TreeContextBits'(context_done >> $clog2(Trees))),
        .out_valid_o(waiting[q]),
        .out_ready_i(taken[q]),
        .out_o(oldest[TreeContextBits*q+:TreeContextBits])
    );
  end

  for (genvar tree = 0; tree < Trees; tree++) begin : gen_tree
    logic finish_waiting, finish_free, finish_valid_q, finish_stop_q, empty_waiting, oldest_stop;
    logic [TreeContextBits-1:0] finish_oldest, empty_oldest, oldest_context, finish_context_q;
    logic [StackBits-1:0] oldest_stack, finish_stack_q;
    /* verilator lint_off UNUSEDSIGNAL */  // the queue holds every context
    logic empty_ready;
    /* verilator lint_on UNUSEDSIGNAL */

    fifo #(
        .Width(TreeContextBits),
        .Depth(EmptyDepth)
    ) empty_queue (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .in_valid_i(empty_i && (32'(empty_context_i) & (Trees - 1)) == tree),
        .in_ready_o(empty_ready),
        .in_i(TreeContextBits'(empty_context_i >> $clog2(Trees))),
        .out_valid_o(empty_waiting),
        .out_ready_i(finish_free && !finish_waiting),
        .out_o(empty_oldest)
    );

    // The first queue of the tree's in which one waits.
    always_comb begin
      finish_waiting = 1'b0;
      finish_oldest = oldest[TreeContextBits*tree+:TreeContextBits];
      for (int unsigned q = Queues; q > 0; q--) begin
        if (((q - 1) & (Trees - 1)) == tree && waiting[q-1]) begin
          finish_waiting = 1'b1;
          finish_oldest = oldest[TreeContextBits*(q-1)+:TreeContextBits];
        end
      end
    end
    for (genvar q = tree; q < Queues; q = q + Trees) begin : gen_taken
      logic [Queues-1:0] before_it;
      for (genvar other = 0; other < Queues; other++) begin : gen_before
        assign before_it[other] = other < q && other % Trees == tree && waiting[other];
      end
      assign taken[q] = finish_free && before_it == '0;
    end
    assign finish_free = !finish_valid_q || finish_ready_i[tree];
    assign oldest_context = finish_waiting ? finish_oldest : empty_oldest;

    lut_ram #(
        .Width(StackBits + 1),
        .Depth(TreeContexts)
    ) stack_pointers (
        .clk_i(clk_i),
        .write_i(counted_valid_q && (32'(counted_context_q) & (Trees - 1)) == tree),
        .write_address_i(TreeContextBits'(counted_context_q >> $clog2(Trees))),
        .write_data_i({leaf_stop, counted_stack_q}),
        .read_address_i(oldest_context),
        .read_data_o({oldest_stop, oldest_stack})
    );

    always_ff @(posedge clk_i) begin
      if (finish_free) begin
        finish_valid_q <= finish_waiting || empty_waiting;
        finish_context_q <= oldest_context;
        finish_stop_q <= oldest_stop;
        finish_stack_q <= oldest_stack;
      end
      if (rst_i) finish_valid_q <= 1'b0;
    end
    assign finish_valid_o[tree] = finish_valid_q;
    assign finish_context_o[TreeContextBits*tree+:TreeContextBits] = finish_context_q;
    assign finish_stop_o[tree] = finish_stop_q;
    assign finish_stack_o[StackBits*tree+:StackBits] = finish_stack_q;
  end
endmodule

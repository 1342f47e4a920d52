// SPDX-License-Identifier: Apache-2.0
// The stacks of all contexts in block RAM, and a ring of three stages that takes entries off, two of a query at a time:
// up to two entries a cycle, three queries in turn. A query enters when its leaf is done; entries whose subtree is too
// far are dropped; the first that is not leaves by next_*, with its offsets; a query with nothing left, or told to
// stop, leaves by done_*. A subtree is too far iff distance^2 * E > bound * 2^EpsilonShift (the left side was pushed).
// The bound is read in the second cycle after the one in which the query is taken. What leaves is registered.
module photon_gatherer_stack #(
    parameter int unsigned OffsetsBits = 51,
    parameter int unsigned R2Bits = 34,
    parameter int unsigned LineBits = 13,
    parameter int unsigned Contexts = 16,
    parameter int unsigned EpsilonShift = 0,
    parameter int unsigned StackBits = 5,
    parameter int unsigned DistanceBits = 34,
    parameter int unsigned Pushes = 1,  // entries of a query at once; of 2 the one for the even bank is lowest
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned NodeBits = LineBits + 1,
    localparam int unsigned EntryBits = 1 + NodeBits + OffsetsBits + DistanceBits,
    localparam int unsigned PushBits = Pushes == 1 ? EntryBits : 1 + 2 * EntryBits
) (
    input  logic                   clk_i,
    input  logic                   rst_i,
    // push
    input  logic                   push_i,
    input  logic [ContextBits-1:0] push_context_i,
    input  logic [  StackBits-1:0] push_stack_i,    // entries below it
    input  logic [   PushBits-1:0] push_entry_i,    // of two pushes the highest bit says that there is a second one
    // a leaf is done
    input  logic                   in_valid_i,
    output logic                   in_ready_o,
    input  logic [ContextBits-1:0] in_context_i,
    input  logic [  StackBits-1:0] in_stack_i,      // entries
    input  logic                   in_stop_i,
    // bound, read by context
    output logic [ContextBits-1:0] bound_context_o,
    input  logic [     R2Bits-1:0] bound_i,
    // the next subtree
    output logic                   next_valid_o,
    output logic [ContextBits-1:0] next_context_o,
    output logic                   next_leaf_o,     // it is a leaf
    output logic [   NodeBits-1:0] next_node_o,
    output logic [  StackBits-1:0] next_stack_o,
    output logic [OffsetsBits-1:0] next_offsets_o,
    // or the end
    output logic                   done_valid_o,
    output logic [ContextBits-1:0] done_context_o,
    // entries dropped in this cycle
    output logic [            1:0] drop_o
);
  // Entry i is in bank i % 2, so the top two are always in different banks.
  localparam int unsigned RowBits = StackBits > 1 ? StackBits - 1 : 1;
  localparam int unsigned RamBits = ContextBits + RowBits;
  localparam int unsigned CompareBits = (DistanceBits > R2Bits + EpsilonShift) ? DistanceBits : R2Bits + EpsilonShift;

  logic valid_0_q, valid_1_q, valid_2_q, stop_0_q, stop_1_q, stop_2_q;
  logic [ContextBits-1:0] context_0_q, context_1_q, context_2_q;
  logic [StackBits-1:0] stack_0_q, stack_1_q, stack_2_q, top_0, second_0, rest_1, rest_2;
  logic [R2Bits-1:0] bound_2_q;
  logic [1:0] far;  // by bank
  logic [EntryBits-DistanceBits-1:0] next_even_q, next_odd_q;
  logic loop, odd_top, two, far_top, far_second, far_both, goes;

  assign top_0 = stack_0_q - StackBits'(1);
  assign second_0 = stack_0_q - StackBits'(2);

  for (genvar bank = 0; bank < 2; bank++) begin : gen_bank
    logic [EntryBits-1:0] word, word_2_q;
    if (Pushes == 1) begin : gen_one_push
      block_ram #(
          .Width(EntryBits),
          .Depth(1 << RamBits)
      ) entries (
          .clk_i(clk_i),
          .write_i(push_i && push_stack_i[0] == (bank == 1)),
          .write_address_i({push_context_i, RowBits'(push_stack_i >> 1)}),
          .write_data_i(push_entry_i),
          .read_i(1'b1),
          .read_address_i({context_0_q, RowBits'((top_0[0] == (bank == 1) ? top_0 : second_0) >> 1)}),
          .read_data_o(word)
      );
    end else begin : gen_two_pushes
      // The lower one goes to the bank of its number, the second to the other one.
      block_ram #(
          .Width(EntryBits),
          .Depth(1 << RamBits)
      ) entries (
          .clk_i(clk_i),
          .write_i(push_i && (push_stack_i[0] == (bank == 1) || push_entry_i[PushBits-1])),
          .write_address_i({push_context_i, RowBits'((push_stack_i + StackBits'(bank == 0)) >> 1)}),
          .write_data_i(push_entry_i[EntryBits*bank+:EntryBits]),
          .read_i(1'b1),
          .read_address_i({context_0_q, RowBits'((top_0[0] == (bank == 1) ? top_0 : second_0) >> 1)}),
          .read_data_o(word)
      );
    end
    always_ff @(posedge clk_i) word_2_q <= word;
    less_than #(
        .Width(CompareBits)
    ) too_far (
        .a_i(CompareBits'(bound_2_q) << EpsilonShift),
        .b_i(CompareBits'(word_2_q[DistanceBits-1:0])),
        .less_o(far[bank])
    );
  end

  always_ff @(posedge clk_i) begin
    valid_0_q <= loop || in_valid_i;
    context_0_q <= loop ? context_2_q : in_context_i;
    stack_0_q <= loop ? rest_2 : in_stack_i;
    stop_0_q <= loop ? 1'b0 : in_stop_i || in_stack_i == '0;

    valid_1_q <= valid_0_q;
    context_1_q <= context_0_q;
    stack_1_q <= stack_0_q;
    stop_1_q <= stop_0_q;

    valid_2_q <= valid_1_q;
    context_2_q <= context_1_q;
    stack_2_q <= stack_1_q;
    stop_2_q <= stop_1_q;
    bound_2_q <= bound_i;
    if (rst_i) begin
      valid_0_q <= 1'b0;
      valid_1_q <= 1'b0;
      valid_2_q <= 1'b0;
    end
  end

  assign bound_context_o = context_1_q;
  // The top entry's number is one less than their count.
  assign odd_top = !stack_2_q[0];
  assign rest_1 = stack_2_q - StackBits'(1);
  assign rest_2 = stack_2_q - StackBits'(2);
  assign two = rest_1 != '0;
  assign far_top = odd_top ? far[1] : far[0];
  assign far_second = odd_top ? far[0] : far[1];
  assign far_both = far == 2'b11;
  assign goes = !far_top || (two && !far_second);

  assign loop = valid_2_q && !stop_2_q && far_both && rest_1 != '0 && rest_2 != '0;
  assign in_ready_o = !loop;
  assign {next_leaf_o, next_node_o, next_offsets_o} = next_even_q | next_odd_q;

  always_ff @(posedge clk_i) begin
    next_valid_o <= valid_2_q && !stop_2_q && goes;
    next_context_o <= context_2_q;
    next_stack_o <= far_top ? rest_2 : rest_1;
    // What is not chosen is cleared, so that behind the registers an OR is enough.
    next_even_q <= odd_top != far_top ? '0 : gen_bank[0].word_2_q[EntryBits-1:DistanceBits];
    next_odd_q <= odd_top != far_top ? gen_bank[1].word_2_q[EntryBits-1:DistanceBits] : '0;
    done_valid_o <= valid_2_q && (stop_2_q || (!goes && !loop));
    done_context_o <= context_2_q;
    drop_o <= {2{valid_2_q && !stop_2_q && far_top}} & {two && far_second, !(two && far_second)};
    if (rst_i) begin
      next_valid_o <= 1'b0;
      done_valid_o <= 1'b0;
    end
  end
endmodule

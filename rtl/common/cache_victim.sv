// SPDX-License-Identifier: Apache-2.0
// Which way of a set a cache's miss takes: of those that are not held the next in turn that was not used of late, or, where
// all were, the next in turn. A bit a way says that its line was asked for since all others of the set were: a use sets it,
// and clears the others of the set where all would be set. One turn serves all sets and advances with every miss.
//
// set_ahead_i is read; in the cycle after, set_i is what it was, the way of a hit belongs to it, and victim_o is there, chosen in that
// cycle by held_i. With Ahead it is chosen a cycle before, by held_i of set_ahead_i, and a use is written a cycle later. Uses of one set in
// cycles that follow on each other may lose one of their bits, with Ahead those two cycles apart too. clear_i clears the bits of set_i. A choice a
// cycle, but with Ahead none of a cycle that follows on a miss. Not recently used: Tanenbaum, Modern Operating Systems, of pages.
module cache_victim #(
    parameter int unsigned Sets = 64,
    parameter int unsigned Ways = 2,
    parameter bit Ahead = 1'b0,
    localparam int unsigned SetBits = Sets > 1 ? $clog2(Sets) : 1,
    localparam int unsigned WayBits = Ways > 1 ? $clog2(Ways) : 1
) (
    input  logic               clk_i,
    input  logic               rst_i,
    input  logic               clear_i,
    input  logic [SetBits-1:0] set_ahead_i,
    input  logic [SetBits-1:0] set_i,
    input  logic [   Ways-1:0] held_i,
    input  logic               hit_i,
    input  logic [WayBits-1:0] hit_way_i,
    input  logic               miss_i,
    output logic [WayBits-1:0] victim_o
);
  if (Ways > 1) begin : gen_ways
    logic [Ways-1:0] used_q, used_ahead, was_used, spared, now, used;
    logic [WayBits-1:0] turn_q, choice;

    assign was_used = Ahead ? used_ahead : used_q;
    always_comb begin
      spared = (held_i | was_used) == '1 ? held_i : held_i | was_used;
      choice = '0;
      for (int unsigned w = Ways; w > 0; w--) if (!spared[w-1]) choice = WayBits'(w - 1);
      for (int unsigned w = Ways; w > 0; w--) if (!spared[w-1] && WayBits'(w - 1) >= turn_q) choice = WayBits'(w - 1);
    end

    assign now = Ways'(1) << (miss_i ? victim_o : hit_way_i);
    assign used = (used_q | now) == '1 ? now : used_q | now;

    // Which way is used is known late: its bit may be written from registers.
    /* verilator lint_off UNDRIVEN */
    /* verilator lint_off UNUSEDSIGNAL */
    // where Ahead
    logic later_write;
    logic [SetBits-1:0] later_set;
    logic [Ways-1:0] later_used;
    /* verilator lint_on UNUSEDSIGNAL */
    /* verilator lint_on UNDRIVEN */
    if (Ahead) begin : gen_ahead
      logic write_q, clear_q;
      logic [SetBits-1:0] set_q;
      logic [Ways-1:0] before_q, now_q;
      logic [WayBits-1:0] victim_q;
      assign victim_o = victim_q;
      always_ff @(posedge clk_i) begin
        victim_q <= choice;
        write_q <= clear_i || hit_i || miss_i;
        {clear_q, set_q, before_q, now_q} <= {clear_i, set_i, used_q, now};
      end
      assign later_write = write_q;
      assign later_set = set_q;
      assign later_used = clear_q ? '0 : (before_q | now_q) == '1 ? now_q : before_q | now_q;
    end else begin : gen_now
      assign victim_o = choice;
    end

    lut_ram #(
        .Width(Ways),
        .Depth(Sets > 1 ? Sets : 2)
    ) used_ways (
        .clk_i(clk_i),
        .write_i(Ahead ? later_write : clear_i || hit_i || miss_i),
        .write_address_i(Ahead ? later_set : set_i),
        .write_data_i(Ahead ? later_used : clear_i ? '0 : used),
        .read_address_i(set_ahead_i),
        .read_data_o(used_ahead)
    );

    always_ff @(posedge clk_i) begin
      used_q <= used_ahead;
      if (miss_i) turn_q <= turn_q == WayBits'(Ways - 1) ? '0 : turn_q + 1'b1;
      if (rst_i) turn_q <= '0;
    end
  end else begin : gen_one_way
    assign victim_o = '0;
    /* verilator lint_off UNUSEDSIGNAL */
    logic unused;
    /* verilator lint_on UNUSEDSIGNAL */
    assign unused = &{1'b0, clk_i, rst_i, clear_i, set_ahead_i, set_i, held_i, hit_i, hit_way_i, miss_i};
  end
endmodule

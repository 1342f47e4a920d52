// SPDX-License-Identifier: Apache-2.0
// Set-associative read cache of lines, several misses outstanding. A line is Items items of ItemBytes bytes; only the
// low ItemBits of each are kept and delivered, a whole line a cycle.
//
// Each of Clients clients has at most one request in flight; answers come by client, in any order. A miss takes one of
// Misses entries, which later requests for the same line join; an entry holds its way until all who wait for it have
// read, so a line cannot be evicted between its arrival and its use. Where every way of the set is held so, or no
// entry is free, requests wait; entries free themselves without them, so there is no deadlock. The victim is the next
// way in turn that is not held.
//
// An answer is issued only with out_ready_i, comes a cycle later, straight from block RAM, and must then be taken; the issue itself is shown by
// issue_o, so the receiver can count its room. Line port: beats of a line in order and not interleaved, lines in any
// order of tags, always accepted. invalidate_i (while idle) forgets every line in Sets cycles, as reset does.
// set_mask_i (while idle, before an invalidate): sets in use minus one; bypass_i: every request fetches its line.
//
// Latency of a hit 3 cycles from in_valid_i, a line a cycle; a miss adds the memory's latency, its beats and 3 cycles.
module cache #(
    parameter int unsigned AddressBits = 14,
    parameter int unsigned Clients = 16,
    parameter int unsigned Items = 8,
    parameter int unsigned ItemBytes = 16,
    parameter int unsigned ItemBits = 96,
    parameter int unsigned BeatBits = 128,
    parameter int unsigned Sets = 64,
    parameter int unsigned Ways = 2,
    parameter int unsigned Misses = 8,
    localparam int unsigned ClientBits = Clients > 1 ? $clog2(Clients) : 1,
    localparam int unsigned MissBits = Misses > 1 ? $clog2(Misses) : 1,
    localparam int unsigned SetBits = Sets > 1 ? $clog2(Sets) : 1
) (
    input  logic                      clk_i,
    input  logic                      rst_i,
    input  logic                      invalidate_i,
    input  logic [       SetBits-1:0] set_mask_i,
    input  logic                      bypass_i,
    // requests
    input  logic                      in_valid_i,
    output logic                      in_ready_o,
    input  logic [    ClientBits-1:0] in_client_i,
    input  logic [   AddressBits-1:0] in_address_i,
    // answers
    input  logic                      out_ready_i,
    output logic                      issue_o,
    output logic                      out_valid_o,
    output logic [    ClientBits-1:0] out_client_o,
    output logic [Items*ItemBits-1:0] out_line_o,
    // memory
    output logic                      line_req_valid_o,
    input  logic                      line_req_ready_i,
    output logic [   AddressBits-1:0] line_req_addr_o,
    output logic [      MissBits-1:0] line_req_tag_o,
    input  logic                      line_rsp_valid_i,
    input  logic [      MissBits-1:0] line_rsp_tag_i,
    input  logic [      BeatBits-1:0] line_rsp_data_i,
    // counted events
    output logic                      hit_o,
    output logic                      miss_o
);
  localparam int unsigned WayBits = Ways > 1 ? $clog2(Ways) : 1;
  localparam int unsigned Beats = (Items * ItemBytes * 8 + BeatBits - 1) / BeatBits;
  localparam int unsigned BeatCountBits = Beats > 1 ? $clog2(Beats) : 1;
  localparam int unsigned TagBits = AddressBits + 1;  // valid, address
  localparam int unsigned PlaceBits = SetBits + WayBits;

  if (Sets < 1 || (Sets & (Sets - 1)) != 0) begin : gen_bad_sets
    cache_sets_must_be_a_power_of_two bad_sets ();
  end

  // ---- lookup: stage a presents the set to the tags, stage b decides ----
  logic b_valid_q, b_take, lookup_ready;
  logic [ClientBits-1:0] b_client_q;
  logic [AddressBits-1:0] b_address_q;
  logic [SetBits-1:0] a_set, b_set;
  logic [Ways*TagBits-1:0] tags;
  logic allocate;
  logic [WayBits-1:0] victim;

  // ---- forgetting: after reset and invalidate_i ----
  logic sweeping_q;
  logic [SetBits-1:0] sweep_q;

  // The set of a request that waits in stage b is presented again, so its tags are never older than its last cycle.
  assign lookup_ready = !b_valid_q || b_take;
  assign in_ready_o = lookup_ready && !sweeping_q;
  assign b_set = SetBits'(b_address_q) & set_mask_i;
  assign a_set = lookup_ready ? SetBits'(in_address_i) & set_mask_i : b_set;

  always_ff @(posedge clk_i) begin
    if (lookup_ready) begin
      b_valid_q <= in_valid_i && !sweeping_q;
      b_client_q <= in_client_i;
      b_address_q <= in_address_i;
    end
    if (rst_i || invalidate_i) begin
      sweeping_q <= 1'b1;
      sweep_q <= '0;
    end else if (sweeping_q) begin
      sweep_q <= sweep_q + 1'b1;
      sweeping_q <= sweep_q != SetBits'(Sets - 1);
    end
    if (rst_i) b_valid_q <= 1'b0;
  end

  for (genvar way = 0; way < Ways; way++) begin : gen_tags
    block_ram #(
        .Width(TagBits),
        .Depth(Sets)
    ) tag_ram (
        .clk_i(clk_i),
        .write_i(sweeping_q || (allocate && victim == WayBits'(way))),
        .write_address_i(sweeping_q ? sweep_q : b_set),
        .write_data_i(sweeping_q ? '0 : {1'b1, b_address_q}),
        .read_i(1'b1),
        .read_address_i(a_set),
        .read_data_o(tags[TagBits*way+:TagBits])
    );
  end

  // ---- misses ----
  logic [Misses-1:0] busy_q, filled_q, same, idle_entry;
  logic [AddressBits-1:0] miss_address_q[0:Misses-1];
  logic [PlaceBits-1:0] miss_place_q[0:Misses-1];  // set, way
  logic [Clients-1:0] waiting_q[0:Misses-1];
  logic [Ways-1:0] held, match;
  logic joins, hits, may_allocate, free_entry, free_way, hit_read;
  logic [MissBits-1:0] entry;
  logic [WayBits-1:0] hit_way, turn_q;

  // A way whose line is on its way does not count as a hit by its tag: the tag may be the one read before its change.
  always_comb begin
    held = '0;
    same = '0;
    for (int unsigned m = 0; m < Misses; m++) begin
      if (busy_q[m]) begin
        for (int unsigned w = 0; w < Ways; w++)
          if (miss_place_q[m] == {b_set, WayBits'(w)}) held[w] = 1'b1;
        same[m] = !bypass_i && miss_address_q[m] == b_address_q;
      end
    end
    match = '0;
    hit_way = '0;
    for (int unsigned w = 0; w < Ways; w++) begin
      match[w] = !bypass_i && !held[w] && tags[TagBits*w+:TagBits] == {1'b1, b_address_q};
      if (match[w]) hit_way = WayBits'(w);
    end
    idle_entry = ~busy_q;
    entry = '0;
    for (int unsigned m = Misses; m > 0; m--) if (idle_entry[m-1]) entry = MissBits'(m - 1);
    victim = '0;
    for (int unsigned w = Ways; w > 0; w--) if (!held[w-1]) victim = WayBits'(w - 1);
    for (int unsigned w = Ways; w > 0; w--) if (!held[w-1] && WayBits'(w - 1) >= turn_q) victim = WayBits'(w - 1);
  end

  assign joins = same != '0;
  assign hits = match != '0 && !joins;
  assign free_entry = idle_entry != '0;
  assign free_way = held != '1;
  assign may_allocate = free_entry && free_way && !line_req_valid_o;
  assign allocate = b_valid_q && !joins && !hits && may_allocate;
  assign b_take = joins || (hits ? hit_read : may_allocate);
  assign hit_o = b_valid_q && b_take && (joins || hits);
  assign miss_o = allocate;

  // ---- who reads next: those who waited for the current entry, else a hit ----
  logic serving_q, serve_last, serve_read;
  logic [MissBits-1:0] serve_entry_q, next_entry;
  logic [Clients-1:0] serve_waiting, serve_rest;
  logic [ClientBits-1:0] serve_client;
  logic serve_joined;

  assign serve_waiting = waiting_q[serve_entry_q];
  assign serve_rest = serve_waiting & (serve_waiting - 1'b1);
  assign serve_joined = b_valid_q && same[serve_entry_q];
  assign serve_last = serve_rest == '0 && !serve_joined;
  assign serve_read = serving_q && out_ready_i && serve_waiting != '0;
  assign hit_read = !serving_q && out_ready_i;
  assign issue_o = serve_read || (b_valid_q && hits && hit_read);

  always_comb begin
    serve_client = '0;
    for (int unsigned c = Clients; c > 0; c--) if (serve_waiting[c-1]) serve_client = ClientBits'(c - 1);
    next_entry = '0;
    for (int unsigned m = Misses; m > 0; m--) if (filled_q[m-1]) next_entry = MissBits'(m - 1);
  end

  // ---- filling ----
  logic fill_q;
  logic [MissBits-1:0] fill_entry_q;
  logic [BeatCountBits-1:0] beat_q;
  /* verilator lint_off UNUSEDSIGNAL */  // the padding of items and line
  logic [Beats*BeatBits-1:0] raw_q;
  /* verilator lint_on UNUSEDSIGNAL */
  logic [Items*ItemBits-1:0] fill_line;

  for (genvar item = 0; item < Items; item++) begin : gen_item
    assign fill_line[ItemBits*item+:ItemBits] = raw_q[ItemBytes*8*item+:ItemBits];
  end

  always_ff @(posedge clk_i) begin
    fill_q <= line_rsp_valid_i && beat_q == BeatCountBits'(Beats - 1);
    fill_entry_q <= line_rsp_tag_i;
    if (line_rsp_valid_i) begin
      raw_q <= (Beats * BeatBits)'({line_rsp_data_i, raw_q} >> BeatBits);
      beat_q <= beat_q == BeatCountBits'(Beats - 1) ? '0 : beat_q + 1'b1;
    end
    if (rst_i) begin
      fill_q <= 1'b0;
      beat_q <= '0;
    end
  end

  always_ff @(posedge clk_i) begin
    if (line_req_valid_o && line_req_ready_i) line_req_valid_o <= 1'b0;
    if (allocate) begin
      line_req_valid_o <= 1'b1;
      line_req_addr_o <= b_address_q;
      line_req_tag_o <= entry;
      turn_q <= turn_q == WayBits'(Ways - 1) ? '0 : turn_q + 1'b1;
    end
    for (int unsigned m = 0; m < Misses; m++) begin
      // A bit is set by its client's request and cleared by its read; no client is at both.
      for (int unsigned c = 0; c < Clients; c++) begin
        if (serve_read && serve_entry_q == MissBits'(m) && serve_client == ClientBits'(c)) waiting_q[m][c] <= 1'b0;
        if (b_client_q == ClientBits'(c) && ((b_valid_q && same[m]) || (allocate && entry == MissBits'(m))))
          waiting_q[m][c] <= 1'b1;
      end
      if (fill_q && fill_entry_q == MissBits'(m)) filled_q[m] <= 1'b1;
      if (serve_read && serve_last && serve_entry_q == MissBits'(m)) begin
        busy_q[m] <= 1'b0;
        filled_q[m] <= 1'b0;
      end
      if (allocate && entry == MissBits'(m)) begin
        busy_q[m] <= 1'b1;
        miss_address_q[m] <= b_address_q;
        miss_place_q[m] <= {b_set, victim};
      end
      if (rst_i) waiting_q[m] <= '0;
    end
    if (serve_read && serve_last) serving_q <= 1'b0;
    if (!serving_q) begin
      serve_entry_q <= next_entry;
      serving_q <= filled_q != '0;
    end
    if (rst_i) begin
      busy_q <= '0;
      filled_q <= '0;
      serving_q <= 1'b0;
      line_req_valid_o <= 1'b0;
      turn_q <= '0;
    end
  end

  // ---- data ----
  logic [PlaceBits-1:0] read_place, fill_place;

  assign read_place = serving_q ? miss_place_q[serve_entry_q] : {b_set, hit_way};
  assign fill_place = miss_place_q[fill_entry_q];

  block_ram #(
      .Width(Items * ItemBits),
      .Depth(1 << PlaceBits)
  ) lines (
      .clk_i(clk_i),
      .write_i(fill_q),
      .write_address_i(fill_place),
      .write_data_i(fill_line),
      .read_i(1'b1),
      .read_address_i(read_place),
      .read_data_o(out_line_o)
  );

  always_ff @(posedge clk_i) begin
    out_valid_o <= issue_o;
    out_client_o <= serving_q ? serve_client : b_client_q;
    if (rst_i) out_valid_o <= 1'b0;
  end
endmodule

// SPDX-License-Identifier: Apache-2.0
// Set-associative read cache of lines, several misses outstanding. A line is Items items of ItemBytes bytes; only the
// low ItemBits of each are kept. It is delivered in Parts parts, the first items first, one a cycle. HeaderBits of each item
// above those are kept too; all of a line, those of its first item lowest, come with every part.
//
// Each of Clients clients has at most one request in flight, which is always taken; answers come by client, in any
// order. A miss takes one of Misses entries, which holds its way until its client begins to read. Whatever cannot be
// served at once (the line is on its way, no entry is free, every way of the set is held, tags that are just being
// changed) goes to a queue and is looked up again when no new request comes. A request that misses is served by its own
// entry, so each is served after finitely many rounds. The victim is a way that is not held: cache_victim.
//
//   stage 0  choose a request    1  tag memory    2  held ways    3  compare, decide    hit: wait for the reader
//
// With CompareStage it is decided in a stage 4 of its own, by what was compared before it: for clocks at which both are too long. Then what
// is held, and which way a miss takes, is known a cycle ahead: what might begin to be held meanwhile counts as held. And of
// hits two wait for the reader, so that none needs to know of it in its own cycle.
//
// ready_i says that there is room for a line and issue_o that one begins: its parts follow from the second cycle after,
// straight from the memory of cache_lines, and must be taken. Line port: beats of a line in order and not interleaved, lines in any
// order of tags, always accepted. invalidate_i (while idle) forgets every line in Sets cycles, as reset does.
// set_mask_i (while idle, before an invalidate): sets in use minus one; bypass_i: every request fetches its line.
//
// With Parity the memories of lines and tags have a parity bit a word, and a beat has one bit more, the highest: it was not
// read right where it comes from. out_wrong_o tells of the part of the cycle before that it is not right, in either
// place; a tag that is not right matches no request, so its line is fetched anew (tag_wrong_o). Either way the line is
// forgotten.
//
// Latency of a hit 5 cycles from in_valid_i, with CompareStage 6, a line in Parts cycles; a miss adds the memory's latency, its beats and 2.
module cache #(
    parameter int unsigned AddressBits = 14,
    parameter int unsigned Clients = 16,
    parameter int unsigned Items = 8,
    parameter int unsigned ItemBytes = 16,
    parameter int unsigned ItemBits = 96,
    parameter int unsigned HeaderBits = 0,
    parameter int unsigned Parts = 2,
    parameter int unsigned BeatBits = 128,
    parameter int unsigned Parity = 0,
    parameter int unsigned Sets = 64,
    parameter int unsigned Ways = 2,
    parameter int unsigned Misses = 8,
    parameter bit CompareStage = 1'b0,  // a stage for the comparison of tags alone
    localparam int unsigned ClientBits = Clients > 1 ? $clog2(Clients) : 1,
    localparam int unsigned MissBits = Misses > 1 ? $clog2(Misses) : 1,
    localparam int unsigned SetBits = Sets > 1 ? $clog2(Sets) : 1,
    localparam int unsigned PartBits = Parts > 1 ? $clog2(Parts) : 1,
    localparam int unsigned DataBits = Items / Parts * ItemBits,
    localparam int unsigned LineHeaderBits = HeaderBits > 0 ? Items * HeaderBits : 1
) (
    input  logic                   clk_i,
    input  logic                   rst_i,
    input  logic                   invalidate_i,
    input  logic [    SetBits-1:0] set_mask_i,
    input  logic                   bypass_i,
    // requests
    input  logic                   in_valid_i,
    input  logic [ ClientBits-1:0] in_client_i,
    input  logic [AddressBits-1:0] in_address_i,
    // answers
    input  logic                   ready_i,
    output logic                   issue_o,
    output logic                   out_valid_o,
    output logic [ ClientBits-1:0] out_client_o,
    output logic [   PartBits-1:0] out_part_o,
    output logic [   DataBits-1:0] out_data_o,
    output logic [LineHeaderBits-1:0] out_header_o,
    output logic                   out_wrong_o,  // the part of the cycle before
    // memory
    output logic                   line_req_valid_o,
    input  logic                   line_req_ready_i,
    output logic [AddressBits-1:0] line_req_addr_o,
    output logic [   MissBits-1:0] line_req_tag_o,
    input  logic                   line_rsp_valid_i,
    input  logic [   MissBits-1:0] line_rsp_tag_i,
    input  logic [BeatBits+Parity-1:0] line_rsp_data_i,
    // counted events
    output logic                   hit_o,
    output logic                   miss_o,
    output logic                   tag_wrong_o
);
  localparam int unsigned WayBits = Ways > 1 ? $clog2(Ways) : 1;
  localparam int unsigned PlaceBits = SetBits + WayBits;  // set, way
  localparam int unsigned TagBits = AddressBits + 1;  // valid, address
  localparam int unsigned QueueDepth = Clients > 2 ? (1 << $clog2(Clients)) : 2;

  if (Sets < 1 || (Sets & (Sets - 1)) != 0) begin : gen_bad_sets
    cache_sets_must_be_a_power_of_two bad_sets ();
  end
  if (Items % Parts != 0) begin : gen_bad_parts
    cache_parts_must_divide_items bad_parts ();
  end

  // ---- forgetting: after reset and invalidate_i ----
  logic sweeping_q;
  logic [SetBits-1:0] sweep_q;

  always_ff @(posedge clk_i) begin
    if (rst_i || invalidate_i) begin
      sweeping_q <= 1'b1;
      sweep_q <= '0;
    end else if (sweeping_q) begin
      sweep_q <= sweep_q + 1'b1;
      sweeping_q <= sweep_q != SetBits'(Sets - 1);
    end
  end

  // ---- stages 0 to 2 ----
  // A lookup is stale when a tag of its set is written in the cycle in which it reads or later, until it is decided: then it is
  // made again.
  logic queue_valid, allocate;
  logic [ClientBits-1:0] queue_client, client_1_q, client_2_q, client_3_q;
  logic [AddressBits-1:0] queue_address, address_1_q, address_2_q, address_3_q;
  logic valid_1_q, valid_2_q, valid_3_q, stale_2_q, stale_3_q;
  logic [SetBits-1:0] set_1, set_2, set_3_q;
  logic [Ways*TagBits-1:0] tags, tags_3_q;
  logic [Ways-1:0] tag_odd, tag_odd_3;
  logic expel;  // a line is forgotten
  logic [PlaceBits-1:0] expel_place;
  logic [Ways-1:0] pending_2, pending_3_q;  // of the set of stage 2, of stage 3

  assign set_1 = SetBits'(address_1_q) & set_mask_i;
  assign set_2 = SetBits'(address_2_q) & set_mask_i;

  always_ff @(posedge clk_i) begin
    valid_1_q <= in_valid_i || queue_valid;
    client_1_q <= in_valid_i ? in_client_i : queue_client;
    address_1_q <= in_valid_i ? in_address_i : queue_address;

    valid_2_q <= valid_1_q;
    client_2_q <= client_1_q;
    address_2_q <= address_1_q;
    stale_2_q <= sweeping_q || (allocate && set_1 == set_d) || (expel && set_1 == expel_place[WayBits+:SetBits]);

    valid_3_q <= valid_2_q;
    client_3_q <= client_2_q;
    address_3_q <= address_2_q;
    set_3_q <= set_2;
    stale_3_q <= stale_2_q || sweeping_q || (allocate && set_2 == set_d);
    tags_3_q <= tags;
    pending_3_q <= pending_2;
    if (rst_i) begin
      valid_1_q <= 1'b0;
      valid_2_q <= 1'b0;
      valid_3_q <= 1'b0;
    end
  end

  // ---- decide: in stage 3, or with CompareStage in stage 4 ----
  // set_ahead is that of the stage before.
  logic valid_d, stale_d;
  logic [ClientBits-1:0] client_d;
  logic [AddressBits-1:0] address_d;
  logic [SetBits-1:0] set_d, set_ahead;
  logic [Ways-1:0] match, match_d;
  /* verilator lint_off UNDRIVEN */
  /* verilator lint_off UNUSEDSIGNAL */
  logic [Ways-1:0] tag_odd_d;  // where CompareStage and Parity
  /* verilator lint_on UNUSEDSIGNAL */
  /* verilator lint_on UNDRIVEN */
  logic [WayBits-1:0] hit_way, hit_way_d;
  if (CompareStage) begin : gen_compare_stage
    logic valid_4_q, stale_4_q;
    logic [ClientBits-1:0] client_4_q;
    logic [AddressBits-1:0] address_4_q;
    logic [SetBits-1:0] set_4_q;
    logic [Ways-1:0] match_4_q, tag_odd_4_q;
    logic [WayBits-1:0] hit_way_4_q;
    always_ff @(posedge clk_i) begin
      valid_4_q <= valid_3_q && !rst_i;
      stale_4_q <= stale_3_q || sweeping_q || (allocate && set_3_q == set_4_q);
      {client_4_q, address_4_q, set_4_q} <= {client_3_q, address_3_q, set_3_q};
      {match_4_q, hit_way_4_q, tag_odd_4_q} <= {match, hit_way, tag_odd_3};
    end
    assign {valid_d, stale_d, client_d, address_d, set_d} = {valid_4_q, stale_4_q, client_4_q, address_4_q, set_4_q};
    assign {match_d, hit_way_d, tag_odd_d} = {match_4_q, hit_way_4_q, tag_odd_4_q};
    assign set_ahead = set_3_q;
  end else begin : gen_compare_and_decide
    assign valid_d = valid_3_q;
    assign stale_d = stale_3_q;
    assign client_d = client_3_q;
    assign address_d = address_3_q;
    assign set_d = set_3_q;
    assign match_d = match;
    assign hit_way_d = hit_way;
    assign set_ahead = set_2;
  end

  logic hit_valid_q, reader_valid_q, hit_take, hit_room, retry;
  logic [PlaceBits-1:0] hit_place_q, hit_place, reader_place_q;
  logic [ClientBits-1:0] hit_client_q, hit_client, reader_client_q;
  logic [Ways-1:0] held;  // with CompareStage of the set decided next
  /* verilator lint_off UNDRIVEN */
  /* verilator lint_off UNUSEDSIGNAL */
  // with CompareStage: every way is held of the set decided, the second hit that waits, and sets that are the one decided next
  logic [Ways-1:0] pending_4_q;
  logic all_held_q, second_valid_q, same_second, same_reader;
  logic [PlaceBits-1:0] second_place_q;
  logic [ClientBits-1:0] second_client_q;
  /* verilator lint_on UNUSEDSIGNAL */
  /* verilator lint_on UNDRIVEN */
  logic same_3, same_hit, hit_same_q, reader_same_q;  // the set decided next, that of the hit, the one read: set_d
  logic [WayBits-1:0] victim;
  logic found, hits, free_q;  // free: an entry of the misses
  logic [MissBits-1:0] entry_q;

  always_comb begin
    hit_way = '0;
    for (int unsigned w = 0; w < Ways; w++) begin
      match[w] = !bypass_i && !tag_odd_3[w] && tags_3_q[TagBits*w+:TagBits] == {1'b1, address_3_q};
      if (match[w]) hit_way = WayBits'(w);
      held[w] = CompareStage ? pending_3_q[w] || (valid_d && same_3 && match_d[w]) ||
          (hit_valid_q && same_hit && hit_place_q[0+:WayBits] == WayBits'(w)) ||
          (second_valid_q && same_second && second_place_q[0+:WayBits] == WayBits'(w)) ||
          (reader_valid_q && same_reader && reader_place_q[0+:WayBits] == WayBits'(w)) :
          pending_3_q[w] || (hit_valid_q && hit_same_q && hit_place_q[0+:WayBits] == WayBits'(w)) ||
          (reader_valid_q && reader_same_q && reader_place_q[0+:WayBits] == WayBits'(w));
    end
  end

  if (CompareStage) begin : gen_ahead
    always_ff @(posedge clk_i) begin
      pending_4_q <= pending_3_q;
      all_held_q <= held == '1;
      second_valid_q <= !hit_room && (second_valid_q || hits) && !rst_i;
      if (!second_valid_q) begin
        second_place_q <= {set_d, hit_way_d};
        second_client_q <= client_d;
      end
    end
    assign same_second = set_ahead == second_place_q[WayBits+:SetBits];
    assign same_reader = set_ahead == reader_place_q[WayBits+:SetBits];
  end

  assign found = match_d != '0;
  assign hit_room = !hit_valid_q || hit_take;
  assign hit_place = hit_valid_q ? hit_place_q : {set_d, hit_way_d};
  assign hit_client = hit_valid_q ? hit_client_q : client_d;
  assign hits = (CompareStage ? valid_d && !stale_d : valid_3_q && !stale_3_q) && (match_d & ~(CompareStage ? pending_4_q : pending_3_q)) != '0 &&
      (CompareStage ? !second_valid_q : hit_room);
  assign allocate = (CompareStage ? valid_d && !stale_d : valid_3_q && !stale_3_q) && !found && free_q && (CompareStage ? !all_held_q : held != '1) && !line_req_valid_o;
  assign retry = valid_d && !hits && !allocate;
  assign {hit_o, miss_o} = {hits, allocate};

  /* verilator lint_off UNUSEDSIGNAL */  // the queue holds every client
  logic queue_ready;
  /* verilator lint_on UNUSEDSIGNAL */
  fifo #(.Width(ClientBits + AddressBits), .Depth(QueueDepth)) again (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(retry),
      .in_ready_o(queue_ready),
      .in_i({client_d, address_d}),
      .out_valid_o(queue_valid),
      .out_ready_i(!in_valid_i),
      .out_o({queue_client, queue_address})
  );

  for (genvar way = 0; way < Ways; way++) begin : gen_tags
    logic [TagBits-1:0] tag;
    logic [TagBits+Parity-1:0] tag_write, tag_read;
    assign tag = sweeping_q || expel ? '0 : {1'b1, address_d};
    assign tags[TagBits*way+:TagBits] = tag_read[TagBits-1:0];
    if (Parity != 0) begin : gen_tag_parity
      assign tag_write = {^tag, tag};
      assign tag_odd[way] = ^tag_read;
    end else begin : gen_no_tag_parity
      assign tag_write = tag;
      assign tag_odd[way] = 1'b0;
    end
    block_ram #(
        .Width(TagBits + Parity),
        .Depth(Sets)
    ) tag_ram (
        .clk_i(clk_i),
        .write_i(sweeping_q || (allocate && victim == WayBits'(way)) ||
            (expel && expel_place[0+:WayBits] == WayBits'(way))),
        .write_address_i(sweeping_q ? sweep_q : expel ? expel_place[WayBits+:SetBits] : set_d),
        .write_data_i(tag_write),
        .read_i(1'b1),
        .read_address_i(set_1),
        .read_data_o(tag_read)
    );
  end

  cache_victim #(
      .Sets(Sets),
      .Ways(Ways),
      .Ahead(CompareStage)
  ) to_take (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .clear_i(sweeping_q),
      .set_ahead_i(set_ahead),
      .set_i(sweeping_q ? sweep_q : set_d),
      .held_i(held),
      .hit_i(hits),
      .hit_way_i(hit_way_d),
      .miss_i(allocate),
      .victim_o(victim)
  );

  // ---- lines that are not right ----
  // They are forgotten when no lookup is decided; until then whoever reads one is told as well.
  logic read_wrong;
  if (Parity != 0) begin : gen_expel
    logic out_valid_1_q, expel_q;
    logic [Ways-1:0] tag_odd_3_q;
    logic [PlaceBits-1:0] place_1_q, place_2_q, expel_place_q;
    logic [WayBits-1:0] odd_way;

    always_comb begin
      odd_way = '0;
      for (int unsigned w = Ways; w > 0; w--) if (CompareStage ? tag_odd_d[w-1] : tag_odd_3_q[w-1]) odd_way = WayBits'(w - 1);
    end
    assign tag_wrong_o = valid_d && !stale_d && (CompareStage ? tag_odd_d : tag_odd_3_q) != '0;
    assign out_wrong_o = out_valid_1_q && read_wrong;
    assign tag_odd_3 = tag_odd_3_q;
    assign expel = expel_q && !valid_d && !sweeping_q;
    assign expel_place = expel_place_q;
    always_ff @(posedge clk_i) begin
      tag_odd_3_q <= tag_odd;
      out_valid_1_q <= out_valid_o;
      place_1_q <= reader_place_q;
      place_2_q <= place_1_q;
      if (expel) expel_q <= 1'b0;
      if (tag_wrong_o || out_wrong_o) begin
        expel_q <= 1'b1;
        expel_place_q <= out_wrong_o ? place_2_q : {set_d, odd_way};
      end
      if (rst_i) begin
        out_valid_1_q <= 1'b0;
        expel_q <= 1'b0;
      end
    end
  end else begin : gen_no_expel
    assign {tag_wrong_o, out_wrong_o, expel} = '0;
    assign tag_odd_3 = '0;
    assign expel_place = '0;
    /* verilator lint_off UNUSEDSIGNAL */
    logic unused;
    /* verilator lint_on UNUSEDSIGNAL */
    assign unused = &{1'b0, read_wrong, tag_odd};
  end

  // ---- misses ----
  // Allocations are at least two cycles apart, since the request of one waits in its register for a cycle; so the free
  // entry can be chosen a cycle ahead.
  logic [Misses-1:0] busy_q, filled_q;
  logic [PlaceBits-1:0] miss_place_q[0:Misses-1];
  logic serve, any_filled, filled;  // filled: the last part of a line is being written
  logic [MissBits-1:0] serve_entry, fill_entry;
  logic [PlaceBits-1:0] fill_place, serve_place;
  logic [ClientBits-1:0] serve_client;

  always_comb begin
    for (int unsigned w = 0; w < Ways; w++) begin
      pending_2[w] = 1'b0;
      for (int unsigned m = 0; m < Misses; m++)
        if (busy_q[m] && miss_place_q[m] == {set_2, WayBits'(w)}) pending_2[w] = 1'b1;
    end
    any_filled = filled_q != '0;
    serve_entry = '0;
    for (int unsigned m = Misses; m > 0; m--) if (filled_q[m-1]) serve_entry = MissBits'(m - 1);
  end

  always_ff @(posedge clk_i) begin
    free_q <= busy_q != '1;
    for (int unsigned m = Misses; m > 0; m--) if (!busy_q[m-1]) entry_q <= MissBits'(m - 1);
    for (int unsigned m = 0; m < Misses; m++) begin
      if (filled && fill_entry == MissBits'(m)) filled_q[m] <= 1'b1;
      if (serve && serve_entry == MissBits'(m)) begin
        busy_q[m] <= 1'b0;
        filled_q[m] <= 1'b0;
      end
      if (allocate && entry_q == MissBits'(m)) begin
        busy_q[m] <= 1'b1;
        miss_place_q[m] <= {set_d, victim};
      end
    end
    if (line_req_ready_i) line_req_valid_o <= 1'b0;
    if (allocate) begin
      line_req_valid_o <= 1'b1;
      line_req_addr_o <= address_d;
      line_req_tag_o <= entry_q;
    end
    if (rst_i) begin
      busy_q <= '0;
      filled_q <= '0;
      line_req_valid_o <= 1'b0;
    end
  end

  lut_ram #(
      .Width(PlaceBits + ClientBits),
      .Depth(Misses > 1 ? Misses : 2)
  ) misses_to_serve (
      .clk_i(clk_i),
      .write_i(allocate),
      .write_address_i(entry_q),
      .write_data_i({set_d, victim, client_d}),
      .read_address_i(serve_entry),
      .read_data_o({serve_place, serve_client})
  );
  lut_ram #(.Width(PlaceBits), .Depth(Misses > 1 ? Misses : 2)) misses_to_fill (
      .clk_i(clk_i),
      .write_i(allocate),
      .write_address_i(entry_q),
      .write_data_i({set_d, victim}),
      .read_address_i(fill_entry),
      .read_data_o(fill_place)
  );

  // ---- the reader: lines that have come go before hits ----
  logic reader_last, reader_free;
  logic [PartBits-1:0] reader_part_q;

  assign reader_last = Parts == 1 || reader_part_q == PartBits'(Parts - 1);
  assign reader_free = !reader_valid_q || reader_last;
  assign serve = any_filled && reader_free && ready_i;
  assign hit_take = !any_filled && reader_free && ready_i;
  assign issue_o = serve || (hit_take && (hit_valid_q || hits));
  assign {same_3, same_hit} = {set_ahead == set_d, set_ahead == hit_place_q[WayBits+:SetBits]};

  always_ff @(posedge clk_i) begin
    // Compared a cycle ahead, since what is held decides which tag is written.
    hit_same_q <= hit_room ? same_3 : same_hit;
    reader_same_q <= !reader_free ? set_ahead == reader_place_q[WayBits+:SetBits] :
        any_filled ? set_ahead == serve_place[WayBits+:SetBits] : hit_valid_q ? same_hit : same_3;
    if (hit_room) begin
      hit_valid_q <= CompareStage ? second_valid_q || (hits && (hit_valid_q || !hit_take)) : hits && (hit_valid_q || !hit_take);
      hit_place_q <= (CompareStage ? second_valid_q : 1'b0) ? second_place_q : {set_d, hit_way_d};
      hit_client_q <= (CompareStage ? second_valid_q : 1'b0) ? second_client_q : client_d;
    end
    if (reader_free) begin
      reader_valid_q <= issue_o;
      reader_place_q <= any_filled ? serve_place : hit_place;
      reader_client_q <= any_filled ? serve_client : hit_client;
      reader_part_q <= '0;
    end else begin
      reader_part_q <= reader_part_q + 1'b1;
    end
    out_valid_o <= reader_valid_q;
    out_client_o <= reader_client_q;
    if (rst_i) begin
      hit_valid_q <= 1'b0;
      reader_valid_q <= 1'b0;
      out_valid_o <= 1'b0;
    end
  end

  cache_lines #(
      .Items(Items),
      .ItemBytes(ItemBytes),
      .ItemBits(ItemBits),
      .HeaderBits(HeaderBits),
      .Parts(Parts),
      .BeatBits(BeatBits),
      .Parity(Parity),
      .EntryBits(MissBits),
      .PlaceBits(PlaceBits)
  ) lines (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(line_rsp_valid_i),
      .in_entry_i(line_rsp_tag_i),
      .in_data_i(line_rsp_data_i),
      .fill_entry_o(fill_entry),
      .fill_place_i(fill_place),
      .filled_o(filled),
      .read_place_i(reader_place_q),
      .read_part_i(reader_part_q),
      .read_part_o(out_part_o),
      .read_data_o(out_data_o),
      .read_header_o(out_header_o),
      .read_wrong_o(read_wrong)
  );
endmodule

// SPDX-License-Identifier: Apache-2.0
// photon_gatherer_list for a K of many places: instead of its key, the code of a key stands at its place in LUT RAM
// (photon_gatherer_key_code), with a comparison of as few bits. Whole keys stand in block RAM.
//
//   stage 0   the code of the new key
//   stage a   read all codes of the context, compare with the new one; whole keys of the two tokens ahead are compared
//   stage b   rank = how many go before it by their codes; doubt: does a code equal its own, wherever it is in the order?
//   stage c   in doubt it stays here: the entry at its rank in the order is read and compared whole, the rank is one more while
//             that is smaller. Then it enters iff rank < K: order, code, whole key and count are written
//   stage d   d2 of the entry that is now the last (block RAM), or its own; its load arrives
//   stage e   the new bound is written
//
// Those that go before a token are the first of the order, at least as many as its rank by codes and by the tokens ahead, for
// the list holds the K smallest of what came. So the loop ends at its rank, whatever was in doubt; an entry that is in doubt
// without need costs only its cycles.
//
// One candidate a cycle, any context; 4 cycles for each entry that is compared whole, of more than 24 places with CountAhead 5. ready_o is low meanwhile, and all that
// is in stages 0 to c stays. What goes with the tokens beside this module, loads and ends of leaves, has to stay too.
//
// Of many places far apart it is late to write a code in stage c. With WriteLater it waits in registers of a stage d, which stays while
// stage c is in doubt (the bound's stage d does not), and who is in stage a meanwhile is compared with three whole keys instead of
// two. If that entry takes a new place, the place does not count as taken yet; if it takes the place of the last, the last is still
// compared: a candidate that lies behind an entry which is gone lies behind K others too.
//
// Starts, slot store and bounds are those of photon_gatherer_list, a cycle later.
module photon_gatherer_coded_list #(
    parameter int unsigned K = 16,
    parameter int unsigned R2Bits = 34,
    parameter int unsigned IndexBits = 16,
    parameter int unsigned Contexts = 16,
    parameter int unsigned LoadBits = 48,
    parameter int unsigned CodeBits = 20,
    parameter int unsigned ExponentBits = 3,
    parameter int unsigned Known = 0,  // a token brings the exponent of its code above its d2
    parameter bit CountAhead = 1'b0,  // which places have an entry is known in stage 0, with what is written then
    parameter bit WriteLater = 1'b0,  // with CountAhead: a code is written a cycle after it is known whether it enters
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned PlaceBits = K > 1 ? $clog2(K) : 1,
    localparam int unsigned CountBits = $clog2(K + 1),
    localparam int unsigned StoreBits = LoadBits + R2Bits + IndexBits
) (
    input  logic                           clk_i,
    input  logic                           rst_i,
    // tokens; all that comes with them or after them stays while not ready
    output logic                           ready_o,
    input  logic                           in_valid_i,
    input  logic [        ContextBits-1:0] in_context_i,
    input  logic                           in_candidate_i,
    input  logic                           in_start_i,
    input  logic                           in_snapshot_i,
    input  logic [          IndexBits-1:0] in_index_i,
    input  logic [R2Bits+Known*ExponentBits-1:0] in_d2_i,
    input  logic [           LoadBits-1:0] load_i,           // four cycles after its token was taken, those in which it is not ready left out
    // a start is done: five cycles after its token, with r2_max of its map, given from the token until then
    output logic                           started_o,
    input  logic [             R2Bits-1:0] r2_max_i,
    // a bound is written: who reads bounds keeps them by context
    output logic                           bound_write_o,
    output logic [        ContextBits-1:0] bound_context_o,
    output logic [             R2Bits-1:0] bound_o,
    // count and insertions of a context
    input  logic [        ContextBits-1:0] read_context_i,
    output logic [          CountBits-1:0] count_o,
    output logic [            IndexBits:0] insertions_o,
    // slot store: a word a cycle after its address
    input  logic                           store_read_i,
    input  logic [        ContextBits-1:0] store_context_i,
    input  logic [          PlaceBits-1:0] store_place_i,
    output logic [          StoreBits-1:0] store_word_o,     // load, d2, index
    // snapshot: places in list order, the first lowest
    output logic                           snapshot_o,
    output logic [          CountBits-1:0] snapshot_count_o,
    output logic [        K*PlaceBits-1:0] snapshot_places_o,
    // counted event, a cycle after a candidate enters
    output logic                           insert_o
);
  localparam int unsigned KeyBits = R2Bits + IndexBits;
  localparam int unsigned RankBits = $clog2(K + 3 + 32'(WriteLater));
  localparam int unsigned Low = IndexBits > 8 ? IndexBits - 8 : 0;  // of the index, in no code: what differs in these alone is rare
  localparam int unsigned DoubtBits = CodeBits > 16 ? 16 : CodeBits;
  localparam int unsigned StateBits = IndexBits + 2;  // full, insertions
  localparam int unsigned Groups = (K + 2) / 3;  // of three places, which are counted before stage b

  // ---- stage 0 ----
  logic [CodeBits-1:0] in_code, a_code_q;
  logic [KeyBits-1:0] a_key_q;
  logic a_candidate_q, a_start_q, a_snapshot_q;
  logic [ContextBits-1:0] a_context_q;

  // ---- stage a ----
  logic [KeyBits-1:0] b_key_q, c_key_q;
  logic [CodeBits-1:0] b_code_q, c_code_q;
  // the code at a place, beside the token's; smaller only where an entry is
  logic [3*Groups-1:0] smaller;
  /* verilator lint_off UNDRIVEN */
  /* verilator lint_off UNUSEDSIGNAL */
  // places that have an entry, where CountAhead
  logic [K-1:0] there;
  /* verilator lint_on UNUSEDSIGNAL */
  /* verilator lint_on UNDRIVEN */
  logic [K-1:0] equal_b_q;
  logic [2*Groups-1:0] smaller_b_q;  // how many of a group
  logic less_b, less_c, ahead_b, ahead_c, ahead_b_q, ahead_c_q;
  logic b_candidate_q, c_candidate_q, b_start_q, c_start_q, b_snapshot_q, c_snapshot_q;
  logic [ContextBits-1:0] b_context_q, c_context_q;
  logic [StateBits-1:0] a_state, c_state, c_state_next, read_state;
  logic [CountBits-1:0] c_count;

  // ---- stage d, where WriteLater: the code that is written, and its whole key ----
  /* verilator lint_off UNDRIVEN */
  /* verilator lint_off UNUSEDSIGNAL */
  logic [CodeBits-1:0] later_code_q;
  logic [ContextBits-1:0] later_context_q;
  logic [K-1:0] later_write;
  logic ahead_d_q;
  /* verilator lint_on UNUSEDSIGNAL */
  /* verilator lint_on UNDRIVEN */

  // ---- stage c, where everything else is written ----
  logic [RankBits-1:0] rank, c_rank_q;
  logic [K*PlaceBits-1:0] order;
  logic [PlaceBits-1:0] place;
  logic c_full, doubt, c_doubt_q, resolved, settled, enters;

  if (WriteLater && !CountAhead) begin : gen_bad_write
    a_place_taken_now_must_not_count write_later_needs_count_ahead ();
  end
  if (Known != 0) begin : gen_known
    photon_gatherer_known_code #(
        .KeyBits(KeyBits - Low),
        .CodeBits(CodeBits),
        .ExponentBits(ExponentBits)
    ) code (
        .key_i({R2Bits'(in_d2_i), in_index_i[IndexBits-1:Low]}),
        .exponent_i(ExponentBits'(in_d2_i >> R2Bits)),
        .code_o(in_code)
    );
  end else begin : gen_found
    photon_gatherer_key_code #(
        .KeyBits(KeyBits - Low),
        .CodeBits(CodeBits),
        .ExponentBits(ExponentBits)
    ) code (
        .key_i({R2Bits'(in_d2_i), in_index_i[IndexBits-1:Low]}),
        .code_o(in_code)
    );
  end
  assign ready_o = !c_doubt_q;

  less_than #(
      .Width(KeyBits)
  ) compare_b (
      .a_i(b_key_q),
      .b_i(a_key_q),
      .less_o(less_b)
  );
  less_than #(
      .Width(KeyBits)
  ) compare_c (
      .a_i(c_key_q),
      .b_i(a_key_q),
      .less_o(less_c)
  );
  assign ahead_b = b_candidate_q && b_context_q == a_context_q && less_b;
  assign ahead_c = c_candidate_q && c_context_q == a_context_q && less_c;

  // value < limit, a constant: of LUTs, where a comparison becomes a carry chain.
  function automatic logic below(input logic [RankBits-1:0] value, input int unsigned limit);
    below = 1'b0;
    for (int unsigned digit = 0; digit < RankBits; digit++)
      below = ((limit >> digit) & 1) != 0 ? below || !value[digit] : below && !value[digit];
  endfunction

  function automatic logic [CountBits-1:0] count_of(input logic [StateBits-1:0] state);
    count_of = state[StateBits-1] ? CountBits'(K) : CountBits'(state[StateBits-2:0]);
  endfunction

  // One subtraction tells whether the code is smaller, and whether it is the same: by the low bits of the difference.
  for (genvar j = 0; j < K; j++) begin : gen_place
    logic [CodeBits-1:0] word;
    logic [CodeBits:0] difference;
    lut_ram #(
        .Width(CodeBits),
        .Depth(Contexts)
    ) codes (
        .clk_i(clk_i),
        .write_i(WriteLater ? later_write[j] : enters && place == PlaceBits'(j)),
        .write_address_i(WriteLater ? later_context_q : c_context_q),
        .write_data_i(WriteLater ? later_code_q : c_code_q),
        .read_address_i(a_context_q),
        .read_data_o(word)
    );
    assign difference = {1'b0, word} - {1'b0, a_code_q};
    assign smaller[j] = difference[CodeBits] &&
        (CountAhead ? there[j] : a_state[StateBits-1] || !below(RankBits'(a_state[IndexBits:0]), j + 1));
    always_ff @(posedge clk_i) begin
      if (!c_doubt_q) equal_b_q[j] <= difference[DoubtBits-1:0] == '0;
    end
  end

  if (CountAhead) begin : gen_there_ahead
    // The token that is written meanwhile has a place more, and where it is a start there are none. Whether it enters is known late,
    // so it chooses between both answers; while it is in doubt nothing is taken. Where its code is written later, it has none yet.
    logic [K-1:0] there_q;
    logic [K:0] now;  // place j - 1 has an entry
    logic same, more, none;
    assign same = c_context_q == in_context_i;
    assign more = same && c_candidate_q && below(c_rank_q, K);
    assign none = same && c_start_q;
    always_comb begin
      now[0] = 1'b1;
      for (int unsigned j = 0; j < K; j++) now[j+1] = a_state[StateBits-1] || !below(RankBits'(a_state[IndexBits:0]), j + 1);
    end
    always_ff @(posedge clk_i) begin
      if (!c_doubt_q)
        for (int unsigned j = 0; j < K; j++) there_q[j] <= !none && (more && !WriteLater ? now[j] : now[j+1]);
    end
    assign there = there_q;
  end

  for (genvar j = K; j < 3 * Groups; j++) begin : gen_no_place
    assign smaller[j] = 1'b0;
  end
  for (genvar g = 0; g < Groups; g++) begin : gen_group
    always_ff @(posedge clk_i) begin
      if (!c_doubt_q) smaller_b_q[2*g+:2] <= 2'(smaller[3*g]) + 2'(smaller[3*g+1]) + 2'(smaller[3*g+2]);
    end
  end

  // ---- stage b ----
  // A tree of LUTs: of a sum of many bits the synthesizer makes a deeper one, which ends in a carry chain.
  function automatic logic [RankBits-1:0] sum(input logic [RankBits-1:0] a, input logic [RankBits-1:0] b);
    logic carry;
    carry = 1'b0;
    for (int unsigned digit = 0; digit < RankBits; digit++) begin
      sum[digit] = a[digit] ^ b[digit] ^ carry;
      carry = (a[digit] & b[digit]) | (carry & (a[digit] | b[digit]));
    end
  endfunction

  logic [RankBits-1:0] part[Groups+1];
  always_comb begin
    for (int unsigned g = 0; g < Groups; g++) part[g] = RankBits'(smaller_b_q[2*g+:2]);
    part[Groups] = sum(RankBits'(ahead_b_q), RankBits'(ahead_c_q));
    if (WriteLater) part[Groups] = RankBits'({(ahead_b_q && ahead_c_q) || (ahead_d_q && (ahead_b_q || ahead_c_q)), ahead_b_q ^ ahead_c_q ^ ahead_d_q});
    for (int unsigned n = Groups + 1; n > 1; n = (n + 1) / 2) begin
      for (int unsigned i = 0; i < n / 2; i++) part[i] = sum(part[2*i], part[2*i+1]);
      if (n % 2 != 0) part[n/2] = part[n-1];
    end
    rank = part[0];
  end
  assign doubt = b_candidate_q && equal_b_q != '0;

  // ---- stage c in doubt: the entry at its rank: place | key, from block RAM | register | compare, and the next one ----
  // Which of many places it is has a cycle of its own.
  localparam int Steps = CountAhead && K > 24 ? 5 : 4;
  logic [Steps-1:0] step_q;
  logic [PlaceBits-1:0] probe_place, probe_place_q;
  logic [KeyBits-1:0] probe_key, probe_key_q;
  logic probe_less;

  /* verilator lint_off UNDRIVEN */
  /* verilator lint_off UNUSEDSIGNAL */
  logic [K-1:0] at_rank_q;
  /* verilator lint_on UNUSEDSIGNAL */
  /* verilator lint_on UNDRIVEN */

  if (Steps == 5) begin : gen_choice
    always_ff @(posedge clk_i) for (int unsigned j = 0; j < K; j++) at_rank_q[j] <= c_rank_q == RankBits'(j);
  end
  always_comb begin
    probe_place = '0;
    for (int unsigned j = 0; j < K; j++)
      if (Steps == 5 ? at_rank_q[j] : c_rank_q == RankBits'(j)) probe_place = probe_place | order[PlaceBits*j+:PlaceBits];
  end
  less_than #(
      .Width(KeyBits)
  ) compare_probe (
      .a_i(probe_key_q),
      .b_i(c_key_q),
      .less_o(probe_less)
  );
  assign resolved = (step_q[0] && c_rank_q >= RankBits'(c_count)) || (step_q[Steps-1] && !probe_less);
  assign settled = c_candidate_q && !c_doubt_q;
  assign enters = settled && below(c_rank_q, K);

  always_ff @(posedge clk_i) begin
    probe_place_q <= probe_place;
    probe_key_q <= probe_key;
    if (c_doubt_q) begin
      step_q <= {step_q[Steps-2:0], step_q[Steps-1]};
      if (step_q[Steps-1] && probe_less) c_rank_q <= c_rank_q + 1'b1;
      c_doubt_q <= !resolved;
    end else begin
      a_candidate_q <= in_valid_i && in_candidate_i;
      a_start_q <= in_valid_i && in_start_i;
      a_snapshot_q <= in_valid_i && in_snapshot_i;
      a_context_q <= in_context_i;
      a_key_q <= {R2Bits'(in_d2_i), in_index_i};
      a_code_q <= in_code;

      b_candidate_q <= a_candidate_q;
      b_start_q <= a_start_q;
      b_snapshot_q <= a_snapshot_q;
      b_context_q <= a_context_q;
      b_key_q <= a_key_q;
      b_code_q <= a_code_q;
      ahead_b_q <= ahead_b;
      ahead_c_q <= ahead_c;

      c_candidate_q <= b_candidate_q;
      c_start_q <= b_start_q;
      c_snapshot_q <= b_snapshot_q;
      c_context_q <= b_context_q;
      c_key_q <= b_key_q;
      c_code_q <= b_code_q;
      c_rank_q <= rank;
      c_doubt_q <= doubt;
      step_q <= Steps'(4'd1);
    end
    if (rst_i) begin
      a_candidate_q <= 1'b0;
      a_start_q <= 1'b0;
      a_snapshot_q <= 1'b0;
      b_candidate_q <= 1'b0;
      b_start_q <= 1'b0;
      b_snapshot_q <= 1'b0;
      c_candidate_q <= 1'b0;
      c_start_q <= 1'b0;
      c_snapshot_q <= 1'b0;
      c_doubt_q <= 1'b0;
    end
  end

  // ---- stage d, where WriteLater; it stays where the others do ----
  if (WriteLater) begin : gen_later
    // A place in two digits of its own.
    localparam int unsigned LowBits = PlaceBits / 2;
    localparam int unsigned HighBits = PlaceBits - LowBits;
    logic enters_q, less_d;
    logic [(1<<LowBits)-1:0] low_q;
    logic [(1<<HighBits)-1:0] high_q;
    logic [KeyBits-1:0] key_q;

    less_than #(
        .Width(KeyBits)
    ) compare_d (
        .a_i(key_q),
        .b_i(a_key_q),
        .less_o(less_d)
    );
    for (genvar j = 0; j < K; j++) begin : gen_write
      assign later_write[j] = !c_doubt_q && high_q[j>>LowBits] && low_q[j%(1<<LowBits)];
    end
    always_ff @(posedge clk_i) begin
      if (!c_doubt_q) begin
        enters_q <= enters;
        for (int unsigned i = 0; i < (1 << LowBits); i++) low_q[i] <= enters && 32'(place) % (1 << LowBits) == i;
        for (int unsigned i = 0; i < (1 << HighBits); i++) high_q[i] <= 32'(place) >> LowBits == i;
        later_context_q <= c_context_q;
        later_code_q <= c_code_q;
        key_q <= c_key_q;
        ahead_d_q <= enters_q && later_context_q == a_context_q && less_d;
      end
      if (rst_i) begin
        enters_q <= 1'b0;
        low_q <= '0;
      end
    end
  end

  // ---- stage c: order ----
  assign c_full = c_state[StateBits-1];
  assign c_count = count_of(c_state);
  assign place = c_full ? order[PlaceBits*(K-1)+:PlaceBits] : PlaceBits'(c_state[IndexBits:0]);

  for (genvar j = 0; j < K; j++) begin : gen_order
    logic [PlaceBits-1:0] left;
    if (j == 0) begin : gen_first
      assign left = place;
    end else begin : gen_other
      assign left = below(c_rank_q, j) ? order[PlaceBits*(j-1)+:PlaceBits] : place;
    end
    lut_ram #(
        .Width(PlaceBits),
        .Depth(Contexts)
    ) entry (
        .clk_i(clk_i),
        .write_i(settled && below(c_rank_q, j + 1)),
        .write_address_i(c_context_q),
        .write_data_i(left),
        .read_address_i(c_context_q),
        .read_data_o(order[PlaceBits*j+:PlaceBits])
    );
  end

  // ---- counts; a start clears them ----
  logic [StateBits-1:0] state_data;

  assign c_state_next[IndexBits:0] = c_state[IndexBits:0] + 1'b1;
  assign c_state_next[StateBits-1] = c_full || CountBits'(c_state[IndexBits:0]) == CountBits'(K - 1);
  assign state_data = c_start_q ? '0 : c_state_next;

  for (genvar r = 0; r < 3; r++) begin : gen_state
    logic [ContextBits-1:0] address;
    logic [StateBits-1:0] data;
    lut_ram #(
        .Width(StateBits),
        .Depth(Contexts)
    ) state (
        .clk_i(clk_i),
        .write_i(enters || c_start_q),
        .write_address_i(c_context_q),
        .write_data_i(state_data),
        .read_address_i(address),
        .read_data_o(data)
    );
  end
  assign gen_state[0].address = CountAhead ? in_context_i : a_context_q;
  assign gen_state[1].address = c_context_q;
  assign gen_state[2].address = read_context_i;
  assign a_state = gen_state[0].data;
  assign c_state = gen_state[1].data;
  assign read_state = gen_state[2].data;
  assign count_o = count_of(read_state);
  assign insertions_o = read_state[IndexBits:0];
  assign insert_o = store_q;
  assign snapshot_o = c_snapshot_q;
  assign snapshot_count_o = c_count;
  assign snapshot_places_o = order;

  // ---- bounds ----
  // The new last is the entry before the last, unless the token itself is.
  logic d_bound_q, d_start_q, d_own_q, e_bound_q, e_start_q;
  logic [ContextBits-1:0] d_context_q, e_context_q;
  logic [R2Bits-1:0] d_own_d2_q, e_d2_q;  // own: of the token, not of the list
  logic [PlaceBits-1:0] before_last;

  if (K == 1) begin : gen_one
    assign before_last = '0;
  end else begin : gen_many
    assign before_last = order[PlaceBits*(K-2)+:PlaceBits];
  end

  block_ram #(
      .Width(KeyBits),
      .Depth(1 << (ContextBits + PlaceBits))
  ) key_by_place (
      .clk_i(clk_i),
      .write_i(enters),
      .write_address_i({c_context_q, place}),
      .write_data_i(c_key_q),
      .read_i(1'b1),
      .read_address_i({c_context_q, c_doubt_q ? probe_place_q : before_last}),
      .read_data_o(probe_key)
  );

  always_ff @(posedge clk_i) begin
    d_bound_q <= c_start_q || (enters && c_state_next[StateBits-1]);
    d_start_q <= c_start_q;
    d_own_q <= c_start_q || c_rank_q == RankBits'(K - 1);
    d_context_q <= c_context_q;
    d_own_d2_q <= c_start_q ? r2_max_i : c_key_q[KeyBits-1:IndexBits];

    e_bound_q <= d_bound_q;
    e_context_q <= d_context_q;
    e_start_q <= d_start_q;
    e_d2_q <= d_own_q ? d_own_d2_q : probe_key[KeyBits-1:IndexBits];
    if (rst_i) begin
      d_bound_q <= 1'b0;
      d_start_q <= 1'b0;
      e_bound_q <= 1'b0;
      e_start_q <= 1'b0;
    end
  end

  assign started_o = e_start_q;

  assign bound_write_o = e_bound_q;
  assign bound_context_o = e_context_q;
  assign bound_o = e_d2_q;

  // ---- slot store: load and key by place ----
  logic store_q;
  logic [ContextBits-1:0] store_context_q;
  logic [PlaceBits-1:0] store_place_q;
  logic [KeyBits-1:0] d_key_q;

  always_ff @(posedge clk_i) begin
    store_q <= enters;
    store_context_q <= c_context_q;
    store_place_q <= place;
    d_key_q <= c_key_q;
    if (rst_i) store_q <= 1'b0;
  end

  block_ram #(
      .Width(StoreBits),
      .Depth(1 << (ContextBits + PlaceBits))
  ) slot_store (
      .clk_i(clk_i),
      .write_i(store_q),
      .write_address_i({store_context_q, store_place_q}),
      .write_data_i({load_i, d_key_q}),
      .read_i(WriteLater ? 1'b1 : store_read_i),  // whether it is read is late
      .read_address_i({store_context_i, store_place_i}),
      .read_data_o(store_word_o)
  );
endmodule

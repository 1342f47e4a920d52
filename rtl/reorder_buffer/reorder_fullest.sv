// SPDX-License-Identifier: Apache-2.0
// Which bin the next packet leaves: fullest. Takes the fullest bin (the lowest number on a tie), fixes its length, stays
// for exactly that many packets, chooses again. One insertion and one take a cycle; a choice needs 2 cycles without an
// insertion before it, and at least 2 * Levels + 2 cycles from one choice to the next. Mirrors kFullest of
// golden/unit/reorder_buffer.cpp.
//
// The lengths are the leaves of a tournament of four players a match, two cycles a level: the player's new entry is put
// among the four, then the best of them found; the leaves are read a cycle before. A choice takes the better of the
// winner at the root, which knows everything up to the last choice, and of the best of the updated that grew since: a bin
// that grows twice beats its own older entry.
module reorder_fullest #(
    parameter int unsigned BinBits = 9,    // at least 2
    parameter int unsigned CountBits = 12  // of the number of packets held
) (
    input  logic               clk_i,
    input  logic               rst_i,
    input  logic               clear_i,       // the order starts afresh; nothing is held
    output logic               ready_o,       // 0 for 2^(BinBits-2) cycles or twice as many after reset
    input  logic               insert_i,      // with a take only where that is taken, and not with one that is alone
    input  logic [BinBits-1:0] insert_bin_i,
    input  logic               take_i,        // held until taken; something is held
    output logic               take_ready_o,  // from registers alone
    output logic               take_alone_o,  // a take of this cycle admits no insertion
    output logic [BinBits-1:0] bin_o
);
  localparam int unsigned Levels = (BinBits + 1) / 2;
  localparam int unsigned PathBits = 2 * Levels;

  logic [PathBits-2:0] walk_q;
  logic walking;
  assign walking = !walk_q[PathBits-2];
  assign ready_o = !walking;

  // An update: the bin that got a packet, or the one that was chosen and now counts nothing. Its count is read, then made,
  // then known.
  logic update_q, update_chosen_q, making_q, making_chosen_q, counted_q, counted_chosen_q;
  logic [PathBits-1:0] update_bin_q, making_bin_q, counted_bin_q;
  logic [CountBits-1:0] new_count, counted_count_q;

  // The wires between levels: the updated bin, and the best of the matches below with its count.
  localparam int unsigned EntryBits = PathBits + CountBits;
  logic [Levels:0] valid;
  logic [(Levels+1)*PathBits-1:0] updated;
  logic [(Levels+1)*EntryBits-1:0] entries;  // {bin below this level, count}

  assign valid[0] = making_q;
  assign updated[0+:PathBits] = making_bin_q;
  assign entries[0+:EntryBits] = {making_bin_q, new_count};

  for (genvar l = 0; l < Levels; l++) begin : gen_level
    localparam int unsigned Below = 2 * l;  // bits of a player's bin
    localparam int unsigned PlayerBits = CountBits + Below;
    localparam int unsigned Depth = 1 << (PathBits - Below - 2);
    localparam int unsigned AddressBits = Depth > 1 ? $clog2(Depth) : 1;

    logic [PathBits-1:0] bin, bin1_q, bin2_q;
    logic [EntryBits-1:0] entry, entry_q;
    logic [1:0] player, winner;
    logic [AddressBits-1:0] address, read_address;
    logic [4*PlayerBits-1:0] stored, word, new_word, match_q;
    logic valid1_q, valid2_q;

    assign bin = updated[l*PathBits+:PathBits];
    assign entry = entries[l*EntryBits+:EntryBits];
    assign player = bin[Below+:2];
    assign address = AddressBits'(bin >> (Below + 2));

    logic unused_entry;
    assign unused_entry = &{1'b0, entry};
    if (l == 0) begin : gen_leaf
      // What the update one cycle ahead has written is not in the memory yet when this one reads.
      logic [4*PlayerBits-1:0] word_q;
      logic [CountBits-1:0] old_count, old_count_q, count;
      logic same_word_q, same_bin_q;
      always_comb begin
        old_count = '0;
        for (int unsigned p = 0; p < 4; p++) begin
          if (update_bin_q[1:0] == 2'(p)) old_count = old_count | stored[CountBits*p+:CountBits];
        end
      end
      always_ff @(posedge clk_i) begin
        word_q <= stored;
        old_count_q <= old_count;
        same_word_q <= making_q && address == read_address;
        same_bin_q <= making_q && making_bin_q == update_bin_q;
      end
      assign read_address = AddressBits'(update_bin_q >> 2);
      assign word = same_word_q ? match_q : word_q;
      assign count = same_bin_q ? counted_count_q : old_count_q;
      assign new_count = making_chosen_q ? '0 : count + 1'b1;
    end else begin : gen_inner
      assign read_address = address;
      assign word = stored;
    end

    lut_ram #(
        .Width(4 * PlayerBits),
        .Depth(Depth)
    ) level_matches (
        .clk_i(clk_i),
        .write_i(walking || valid[l]),
        .write_address_i(walking ? AddressBits'(walk_q) : address),
        .write_data_i(walking ? '0 : new_word),
        .read_address_i(read_address),
        .read_data_o(stored)
    );

    always_comb begin
      new_word = word;
      for (int unsigned p = 0; p < 4; p++) begin
        if (player == 2'(p)) new_word[PlayerBits*p+:PlayerBits] = entry[PlayerBits-1:0];
      end
    end

    // All pairs at once; the lower number wins a tie.
    logic [CountBits-1:0] c0, c1, c2, c3;
    logic beat01, beat02, beat03, beat12, beat13, beat23;
    assign c0 = match_q[0+:CountBits];
    assign c1 = match_q[PlayerBits+:CountBits];
    assign c2 = match_q[2*PlayerBits+:CountBits];
    assign c3 = match_q[3*PlayerBits+:CountBits];
    assign beat01 = c0 >= c1;
    assign beat02 = c0 >= c2;
    assign beat03 = c0 >= c3;
    assign beat12 = c1 >= c2;
    assign beat13 = c1 >= c3;
    assign beat23 = c2 >= c3;
    always_comb begin
      if (beat01 && beat02 && beat03) winner = 2'd0;
      else if (!beat01 && beat12 && beat13) winner = 2'd1;
      else if (!beat02 && !beat12 && beat23) winner = 2'd2;
      else winner = 2'd3;
    end

    logic [PlayerBits-1:0] best;
    always_comb begin
      best = '0;
      for (int unsigned p = 0; p < 4; p++) begin
        if (winner == 2'(p)) best = best | match_q[PlayerBits*p+:PlayerBits];
      end
    end

    always_ff @(posedge clk_i) begin
      valid1_q <= valid[l];
      bin1_q   <= bin;
      match_q  <= new_word;
      valid2_q <= valid1_q;
      bin2_q   <= bin1_q;
      if (valid1_q) entry_q <= EntryBits'({winner, best});
      if (walking) entry_q <= '0;
      if (rst_i) begin
        valid1_q <= 1'b0;
        valid2_q <= 1'b0;
      end
    end
    assign valid[l+1] = valid2_q;
    assign updated[(l+1)*PathBits+:PathBits] = bin2_q;
    assign entries[(l+1)*EntryBits+:EntryBits] = entry_q;
  end

  logic unused;
  assign unused = &{1'b0, valid[Levels], updated[Levels*PathBits+:PathBits]};

  // The choice.
  localparam int unsigned SettleBits = $clog2(2 * Levels + 2);
  logic [CountBits-1:0] root_count, best_count_q, chosen_rest, left_q;
  logic [PathBits-1:0] root_bin, best_bin_q, chosen_bin;
  logic [BinBits-1:0] current_q;
  logic [SettleBits-1:0] settle_q;  // cycles until the root knows of the last choice
  logic fresh, fresh_over_root, fresh_over_best, root_over_best, choose;

  assign {root_bin, root_count} = entries[Levels*EntryBits+:EntryBits];
  // The last count has not been compared with the best yet.
  assign fresh = counted_q && !counted_chosen_q;
  assign fresh_over_root = fresh && {counted_count_q, ~counted_bin_q} > {root_count, ~root_bin};
  assign fresh_over_best = fresh && {counted_count_q, ~counted_bin_q} > {best_count_q, ~best_bin_q};
  assign root_over_best = {root_count, ~root_bin} > {best_count_q, ~best_bin_q};
  always_comb begin
    if (fresh_over_root && fresh_over_best) begin
      chosen_bin  = counted_bin_q;
      chosen_rest = counted_count_q - 1'b1;
    end else if (root_over_best) begin
      chosen_bin  = root_bin;
      chosen_rest = root_count - 1'b1;
    end else begin
      chosen_bin  = best_bin_q;
      chosen_rest = best_count_q - 1'b1;
    end
  end
  assign take_ready_o = left_q != '0 || (!update_q && !making_q && settle_q == '0 && !walking);
  assign take_alone_o = left_q == '0;
  assign choose = take_i && take_ready_o && left_q == '0;
  assign bin_o = left_q != '0 ? current_q : BinBits'(chosen_bin);

  always_ff @(posedge clk_i) begin
    update_q <= insert_i || choose;
    update_chosen_q <= choose;
    update_bin_q <= choose ? chosen_bin : PathBits'(insert_bin_i);

    making_q <= update_q;
    making_chosen_q <= update_chosen_q;
    making_bin_q <= update_bin_q;
    counted_q <= making_q;
    counted_chosen_q <= making_chosen_q;
    counted_bin_q <= making_bin_q;
    counted_count_q <= new_count;
    if (fresh_over_best) begin
      best_count_q <= counted_count_q;
      best_bin_q   <= counted_bin_q;
    end
    if (settle_q != '0) settle_q <= settle_q - 1'b1;
    if (choose) begin
      current_q <= BinBits'(chosen_bin);
      left_q <= chosen_rest;
      best_count_q <= '0;
      settle_q <= SettleBits'(2 * Levels + 1);
    end else if (take_i && take_ready_o) begin
      left_q <= left_q - 1'b1;
    end
    if (walking) walk_q <= walk_q + 1'b1;
    if (rst_i || clear_i) begin
      left_q <= '0;
      best_count_q <= '0;
    end
    if (rst_i) begin
      walk_q    <= '0;
      update_q  <= 1'b0;
      making_q  <= 1'b0;
      counted_q <= 1'b0;
      settle_q  <= '0;
    end
  end
endmodule

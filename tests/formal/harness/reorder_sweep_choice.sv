// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/lut_ram.sv rtl/common/block_ram.sv rtl/common/lowest_bit.sv
// sources: rtl/reorder_buffer/reorder_sweep_counts.sv rtl/reorder_buffer/reorder_sweep_scan.sv
// sources: rtl/reorder_buffer/reorder_sweep.sv
// The choice of the bin that the next packet leaves, by sweep. The packets of all bins are counted. The choice is the bin of
// the last one while that holds something, else the next bin in cyclic order that does, and after the order starts afresh the
// first; so none is chosen while it is empty. While one is not, a choice is there within Limit cycles (no deadlock).
// The environment is the reorder buffer: a take is held until taken; when the pool is full an insertion comes with a take,
// else without; no bin holds more than Packets; the order starts afresh only when nothing is held.
// Limit is reached where a pass ends with an insertion behind it, which it waits for, and the next one begins with two bins
// of one word: the second comes to the row a cycle after the first and holds it up.
module reorder_sweep_choice #(
    parameter int unsigned Lemmas = 1,
    parameter int unsigned BinBits = 2,
    parameter int unsigned Packets = 3,
    parameter int unsigned Limit = 9
) (
    input logic clk_i,
    input logic rst_i,
    input logic clear_i,
    input logic insert_i,
    input logic [BinBits-1:0] insert_bin_i,
    input logic take_i,
    input logic full_i
);
  localparam int unsigned CountBits = $clog2(Packets + 1);
  localparam int unsigned Bins = 1 << BinBits;

  logic ready, take_ready, take_alone, taken;
  logic [BinBits-1:0] bin;

  reorder_sweep #(
      .BinBits(BinBits),
      .CountBits(CountBits)
  ) dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .clear_i(clear_i),
      .ready_o(ready),
      .insert_i(insert_i),
      .insert_bin_i(insert_bin_i),
      .full_i(full_i),
      .take_i(take_i),
      .take_ready_o(take_ready),
      .take_alone_o(take_alone),
      .bin_o(bin)
  );

  logic started_q = 1'b0;
  always_ff @(posedge clk_i) started_q <= 1'b1;
  always_comb assume (rst_i == !started_q);

  assign taken = take_i && take_ready;
  logic [Bins*CountBits-1:0] held_q;  // packets of each bin, bin 0 lowest
  logic any_held, pending_q, chosen_q;
  logic [3:0] waited_q;
  logic [BinBits-1:0] last_bin_q;  // chosen last, where chosen_q
  assign any_held = held_q != '0;
  always_ff @(posedge clk_i) begin
    for (int unsigned b = 0; b < Bins; b++) begin
      held_q[CountBits*b+:CountBits] <= held_q[CountBits*b+:CountBits] +
          CountBits'(insert_i && insert_bin_i == BinBits'(b)) - CountBits'(taken && bin == BinBits'(b));
    end
    waited_q  <= (take_i && !take_ready && any_held) || !ready ? waited_q + 1'b1 : '0;
    pending_q <= take_i && !take_ready && !rst_i;
    if (taken) last_bin_q <= bin;
    chosen_q <= (chosen_q || taken) && !clear_i && !rst_i;
    if (rst_i) begin
      held_q   <= '0;
      waited_q <= '0;
    end
  end

  always_comb begin
    if (!rst_i && insert_i) begin
      assume (ready && (full_i ? taken && !take_alone : !take_i));
      assume (held_q[CountBits*insert_bin_i+:CountBits] != CountBits'(Packets) || (taken && bin == insert_bin_i));
    end
    if (!rst_i && pending_q) assume (take_i);
    if (!rst_i && clear_i) assume (!any_held && !insert_i && !take_i && ready);
  end

  // The sweep's choice: the first bin that holds something, or the first from last_bin_q on.
  logic [BinBits-1:0] first, next_bin;
  logic next_any;
  always_comb begin
    first = '0;
    next_bin = '0;
    next_any = 1'b0;
    for (int unsigned i = 0; i < Bins; i++) begin
      if (held_q[CountBits*(Bins-1-i)+:CountBits] != '0) begin
        first = BinBits'(Bins - 1 - i);
        if (chosen_q && BinBits'(Bins - 1 - i) >= last_bin_q) begin
          next_any = 1'b1;
          next_bin = BinBits'(Bins - 1 - i);
        end
      end
    end
  end

  always_comb begin
    if (!rst_i) begin
      if (taken) assert (any_held && bin == (next_any ? next_bin : first));
      assert (waited_q <= 4'(Limit));
    end
  end

  // What the module holds inside, so that the above follows from one cycle to the next. Probes are kept where no lemma
  // reads them.
  localparam int unsigned BitBits = (BinBits + 1) / 2;
  localparam int unsigned WordBits = BinBits - BitBits;
  localparam int unsigned Width = 1 << BitBits;
  localparam int unsigned Words = 1 << WordBits;
  localparam int unsigned Row = 4;
  (* keep *) logic start, parity, left_any, known1, write1, ahead1, in_row1, beyond1, write2, known2, fills;  // probe
  (* keep *) logic [BinBits-1:0] current, bin1, bin2;  // probe
  (* keep *) logic [CountBits-1:0] left, more;  // probe
  (* keep *) logic [1:0] joins;  // probe
  (* keep *) logic [Words-1:0] this_used, later_used;  // probe
  (* keep *) logic [Row-1:0] valid;  // probe
  (* keep *) logic [Row*BinBits-1:0] row;  // probe
  (* keep *) logic [Width-1:0] set2;  // probe
  (* keep *) logic [2*Width-1:0] words;  // probe
  (* keep *) logic [2*Words*Width-1:0] bits_insert, bits_scan;  // probe: the bitmaps
  (* keep *) logic [Bins*CountBits-1:0] count_insert, count0, count1;  // probe: the numbers
  // Of reorder_sweep_counts.
  (* keep *) logic written, same_count, move1;  // probe
  (* keep *) logic [CountBits-1:0] stored, stored_q, last_count;  // probe
  (* keep *) logic [2*CountBits-1:0] stored_places;  // probe
  (* keep *) logic [1:0] is_void, forward, joined, joining;  // probe
  // Of reorder_sweep_scan.
  (* keep *) logic overflow, load, last_valid, word_valid, next_valid, next_none, search, stale, found_valid;  // probe
  (* keep *) logic candidate_any;  // probe
  (* keep *) logic [BinBits-1:0] last;  // probe
  (* keep *) logic [WordBits-1:0] word, next, candidate;  // probe
  (* keep *) logic [Width-1:0] bits, next_bits, found;  // probe

  if (Lemmas == 1) begin : gen_lemmas
    // Bin by bin: what the bitmap of its pass says, what is on its way there, and where it is looked for.
    logic [Bins-1:0] any, above, in_this, in_later, in_row, beyond, scanned, unseen;
    logic row_any;
    assign row_any = valid != '0;
    for (genvar b = 0; b < Bins; b++) begin : gen_bin
      localparam int unsigned Word = b / Width;
      localparam int unsigned Bit = b % Width;
      logic [CountBits-1:0] count;
      logic one, two, bit_set;
      assign count = held_q[CountBits*b+:CountBits];
      assign any[b] = count != '0;
      assign above[b] = start || BinBits'(b) > current;
      assign in_this[b] = this_used[Word] && bits_scan[Width*(Words*parity+Word)+Bit];
      assign in_later[b] = later_used[Word] && bits_scan[Width*(Words*!parity+Word)+Bit];
      assign one = write1 && bin1 == BinBits'(b);
      assign two = write2 && bin2 == BinBits'(b);
      assign bit_set = above[b] ? in_this[b] : in_later[b];
      logic [Row-1:0] is, over;
      for (genvar i = 0; i < Row; i++) begin : gen_row
        assign is[i] = valid[i] && row[BinBits*i+:BinBits] == BinBits'(b);
        assign over[i] = !valid[i] || row[BinBits*i+:BinBits] < BinBits'(b);
      end
      assign in_row[b] = is != '0;
      assign beyond[b] = &over;
      logic in_found, in_bits, in_next;
      assign in_found = found_valid && word == WordBits'(Word) && found[Bit];
      assign in_bits = word == WordBits'(Word) && bits[Bit];
      assign in_next = next_valid && next == WordBits'(Word) && next_bits[Bit];
      assign scanned[b] = in_found || in_bits || in_next;
      // The scan comes to it from the bitmap.
      assign unseen[b] = in_this[b] && (overflow || load || (!next_none && (!word_valid || word < WordBits'(Word)) &&
          (!next_valid || next < WordBits'(Word))));
      always_comb begin
        if (!rst_i) begin
          // The current bin.
          if (!start && current == BinBits'(b)) assert (count == left && !one && !in_later[b]);
          // Bitmaps.
          if (above[b]) begin
            assert (any[b] == (in_this[b] || one));
            assert (!in_later[b]);
          end
          if (!start && BinBits'(b) < current) assert (any[b] == (in_later[b] || one));
          if (one) assert (ahead1 == above[b]);
          if (one && in_row1) assert (count == CountBits'(1) && !bit_set && !two);
          // Both copies, where they are read.
          if (this_used[Word]) assert (bits_scan[Width*(Words*parity+Word)+Bit] == bits_insert[Width*(Words*parity+Word)+Bit]);
          if (later_used[Word]) assert (bits_scan[Width*(Words*!parity+Word)+Bit] == bits_insert[Width*(Words*!parity+Word)+Bit]);
          if (write1 && bin1[BitBits+:WordBits] == WordBits'(Word)) begin
            assert (words[Width*parity+Bit] == in_this[b]);
            assert (words[Width*!parity+Bit] == in_later[b]);
          end
          // Numbers.
          if (start || current != BinBits'(b)) begin
            if (two) assert (bit_set);
            if (two && !known2) assert (count == CountBits'(1) + CountBits'(one));
            if (!two && !bit_set) assert (count == CountBits'(one));
            if (bit_set && (!two || known2)) begin
              assert (count == count_insert[CountBits*b+:CountBits] + CountBits'(1) + CountBits'(two) + CountBits'(one));
              assert (count == count0[CountBits*b+:CountBits] + CountBits'(1) + CountBits'(two) + CountBits'(one));
              assert (count == count1[CountBits*b+:CountBits] + CountBits'(1) + CountBits'(two) + CountBits'(one));
            end
          end
          if (one) assert ((written ? last_count : stored) == count_insert[CountBits*b+:CountBits]);
          if (two) assert ((same_count ? last_count : stored_q) == count_insert[CountBits*b+:CountBits]);
          if (is[0]) assert (count == more + CountBits'(joins) + CountBits'(1));
          if (is[1] && known1) begin
            assert (count == (is_void[move1] ? '0 : forward[move1] ? last_count : stored_places[CountBits*move1+:CountBits]) +
                CountBits'(joined[move1]) + CountBits'(joining[move1]) + CountBits'(1));
          end
          // The row, and what lies behind it.
          if (in_row[b]) assert (any[b] && above[b]);
          if (any[b] && above[b] && !in_row[b]) begin
            assert (beyond[b]);
            assert ((one && beyond1) || (fills && bin2 == BinBits'(b)) || scanned[b] || unseen[b]);
          end
          if (scanned[b]) assert (any[b] && above[b] && beyond[b] && in_this[b] && !(fills && bin2 == BinBits'(b)));
          if (one && beyond1) assert (above[b] && beyond[b]);
          if (fills && bin2 == BinBits'(b)) assert (write2 && !known2 && above[b] && beyond[b] && set2 == Width'(1) << Bit);
        end
      end
    end

    always_comb begin
      if (!rst_i) begin
        assert (left_any == (left != '0));
        if (start) assert (!left_any && later_used == '0);
        if (!start) assert (chosen_q && last_bin_q == current);
        if (start && chosen_q) assert (pending_q && !next_any);
        if (ahead1 || beyond1) assert (write1);
        if ((write1 && in_row1) || beyond1) assert (ahead1);
        assert (!(in_row1 && beyond1));
        for (int unsigned i = 0; i < Row; i++) begin
          for (int unsigned j = i + 1; j < Row; j++) begin
            if (valid[i] && valid[j]) assert (row[BinBits*i+:BinBits] < row[BinBits*j+:BinBits]);
          end
          if (i > 1 && valid[i]) assert (valid[i-1]);
        end
        // The scan.
        if (found_valid) begin
          assert (word_valid && found != '0 && (found & (found - 1'b1)) == '0);
          assert ((bits & (found | (found - 1'b1))) == '0);
        end
        if (bits != '0) assert (word_valid);
        if (next_valid) assert (!next_none && next_bits != '0);
        if (next_valid && word_valid) assert (next > word);
        if (load) assert (!word_valid && !found_valid && bits == '0 && !next_valid && !next_none && !search && last_valid);
        if (search) assert (!next_valid && !next_none);
        if (!last_valid) assert (start && !row_any && !overflow);
        if (overflow) assert (valid[Row-1]);
        if (last_valid && !overflow) begin
          if (!row_any) assert (!start && last == current);
          for (int unsigned i = 0; i < Row; i++) begin
            if (valid[i] && (i == Row - 1 || !valid[(i+1)%Row]) && (i > 0 || !valid[1])) assert (last == row[BinBits*i+:BinBits]);
          end
        end
        if (word_valid && last_valid) assert (word >= last[BitBits+:WordBits]);
        if (search && !stale) begin
          assert (candidate_any == |(this_used >> (word_valid ? 32'(word) + 1 : 0)));
          for (int unsigned w = 0; w < Words; w++) begin
            if (this_used[w] && (!word_valid || WordBits'(w) > word)) assert (candidate <= WordBits'(w));
          end
          if (candidate_any) assert (this_used[candidate] && (!word_valid || candidate > word));
        end
      end
    end
  end
endmodule

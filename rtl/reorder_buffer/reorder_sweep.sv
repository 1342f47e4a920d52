// SPDX-License-Identifier: Apache-2.0
// Which bin the next packet leaves: sweep. Stays on a bin until it is empty, packets that join meanwhile included, then
// takes the next non-empty bin in cyclic order. One insertion and one choice a cycle, the choice first: it does not see the
// insertion of its cycle. Passing from the last bin to the first takes 7 cycles in which take_ready_o is 0; where bins of
// one packet follow each other, each in another word of the bitmap, a choice takes 3. Mirrors the sweep of
// golden/unit/reorder_buffer.cpp.
//
// A pass goes through the bins upwards. A packet whose bin lies ahead belongs to this pass, one whose bin lies behind to
// the next. Each pass has its bitmap of non-empty bins, in words of which `this_q` and `later_q` say which are in use;
// bits are never cleared, those at and below the current bin are masked and a word out of use counts as 0.
//
// The next few bins wait in a sorted row, where an insertion finds its place at once. Behind it a scan goes through the
// bitmap: the word it is in, the next word, which is fetched meanwhile, and one bin on its way to the row. The bitmaps learn
// of an insertion a cycle after the row, counts and scan two cycles. One that fills a bin beyond the row is put into the words the scan
// holds; where that would be too late, or where the row overflows, the scan starts again after the row's last bin.
module reorder_sweep #(
    parameter int unsigned BinBits = 9,    // at least 2
    parameter int unsigned CountBits = 12  // of the number of packets held
) (
    input  logic               clk_i,
    input  logic               rst_i,
    input  logic               clear_i,       // the order starts afresh; nothing is held
    output logic               ready_o,
    input  logic               insert_i,      // with a take only where that is taken
    input  logic [BinBits-1:0] insert_bin_i,
    input  logic               full_i,        // an insertion of this cycle comes with a take
    input  logic               take_i,        // held until taken; something is held
    output logic               take_ready_o,  // from registers alone
    output logic               take_alone_o,  // a take of this cycle admits no insertion
    output logic [BinBits-1:0] bin_o
);
  localparam int unsigned BitBits = (BinBits + 1) / 2;
  localparam int unsigned WordBits = BinBits - BitBits;
  localparam int unsigned WordWidth = 1 << BitBits;
  localparam int unsigned Words = 1 << WordBits;
  localparam int unsigned Row = 4;

  logic start_q;  // no bin yet in this pass: all bins lie ahead
  logic parity_q;  // which bitmap is this pass's
  logic [BinBits-1:0] current_q;
  logic [CountBits-1:0] left_q;  // packets of the current bin
  logic [Words-1:0] this_q, later_q;
  // The row: place 0 is the next bin. Places in use follow each other; place 0 may be empty while place 1 waits for its
  // number of packets, which has to be read before it moves up.
  logic [Row-1:0] valid_q;
  logic [Row*BinBits-1:0] row_q;
  logic known1_q;  // the number of the bin in place 1 has been read, or there is none
  // The scan.
  logic overflow_q;  // a bin fell out of the row
  logic load_q;  // starts again after the last bin of the row
  logic last_valid_q;  // a bin has entered the row in this pass
  logic [BinBits-1:0] last_q;  // the last bin of the row a cycle ago, or the last that was there
  logic word_valid_q, next_valid_q, next_none_q, search_q, stale_q, candidate_any_q, found_valid_q;
  logic [WordBits-1:0] word_q, next_q, candidate_q;
  logic [WordWidth-1:0] bits_q, next_bits_q;  // what the scan has still to do in its word; all of the next word
  logic [WordWidth-1:0] found_q;  // the bin on its way to the row, in word_q

  assign ready_o = 1'b1;

  // The choice.
  logic left_any_q, pop, move;  // left_q is not 0; the row moves up
  logic insert_pop;  // pop, if there is an insertion
  logic hit;  // the insertion joins the current bin
  assign take_ready_o = left_any_q || valid_q[0];
  assign take_alone_o = 1'b0;
  assign bin_o = left_any_q ? current_q : row_q[0+:BinBits];
  assign pop = take_i && !left_any_q && valid_q[0];
  assign move = (pop || !valid_q[0]) && known1_q;
  assign insert_pop = full_i && !left_any_q;

  // Packets of the bin in place 0 less one, as a sum of two: what was read before it moved up, or the sum of a cycle ago;
  // and what joined since. Both are 0 of a bin that the last insertion put there.
  logic move_q, fresh_q, forward2_q;
  logic [CountBits-1:0] read_q, last2_count_q, sum_q, more;
  logic [1:0] joins_q, joins;
  assign more = fresh_q ? '0 : !move_q ? sum_q : forward2_q ? last2_count_q : read_q;
  assign joins = fresh_q ? '0 : joins_q;

  // What is left of the current bin: one carry chain, the insertion its carry in.
  logic [CountBits-1:0] left;
  logic unused_carry;
  assign {left, unused_carry} = {pop ? more : left_q, 1'b1} +
      {pop ? CountBits'(joins) : {CountBits{take_i && left_any_q}}, hit};

  // Where the new packet's bin lies once the choice is made.
  logic [Row-1:0] below, same;
  logic [Row:0] at;  // it takes this place of the row before that moves up
  logic above_current, above_first, at_current, ahead, in_row, beyond;
  for (genvar i = 0; i < Row; i++) begin : gen_compare
    assign below[i] = valid_q[i] && insert_bin_i < row_q[BinBits*i+:BinBits];
    assign same[i]  = valid_q[i] && insert_bin_i == row_q[BinBits*i+:BinBits];
  end
  assign above_current = start_q || insert_bin_i > current_q;
  assign at_current = !start_q && insert_bin_i == current_q;
  assign above_first = !below[0] && !same[0];
  assign hit = insert_i && (insert_pop ? same[0] : at_current);
  assign ahead = insert_i && (insert_pop ? above_first : above_current);
  // The row is sorted and lies above the current bin: two of its bins tell of a place. Who pops place 0 is behind it.
  assign at[0] = insert_i && !insert_pop && above_current && below[0];
  assign at[1] = insert_i && below[1] && (valid_q[0] ? above_first : above_current);
  for (genvar i = 2; i < Row; i++) begin : gen_place
    assign at[i] = insert_i && below[i] && !below[i-1] && !same[i-1];
  end
  assign at[Row] = 1'b0;
  assign in_row = at != '0;
  assign beyond = ahead && below == '0 && same == '0;

  // The row of the next cycle: the new bin at a place, bins past it, the next bin of the scan behind them all.
  logic [Row-1:0] put, past, appends;
  for (genvar i = 0; i < Row; i++) begin : gen_next
    assign put[i] = move ? at[i+1] : at[i];
    if (i == 0) begin : gen_first
      assign past[i] = 1'b0;
      assign appends[i] = 1'b0;
    end else begin : gen_other
      logic free;  // after the row has moved
      if (i + 1 < Row) begin : gen_inner
        assign free = !valid_q[i+1];
      end else begin : gen_last
        assign free = 1'b1;
      end
      assign past[i] = at[i-1:0] != '0 || (move && at[i]);
      assign appends[i] = move ? free && (i == 1 || valid_q[i]) : !valid_q[i] && valid_q[i-1];
    end
  end

  // The insertion a cycle later.
  logic write_q, ahead_q, in_row_q, beyond_q;
  logic [BinBits-1:0] bin_q;
  logic [WordBits-1:0] word;
  logic [BitBits-1:0] bit_number;
  logic [WordWidth-1:0] set;
  assign {word, bit_number} = bin_q;
  assign set = WordWidth'(1) << bit_number;

  // And two cycles later.
  logic write2_q, known2_q, fills_q;  // fills_q: fills a bin beyond the row
  logic [BinBits-1:0] bin2_q;
  logic [WordBits-1:0] word2;
  logic [WordWidth-1:0] set2_q;
  assign word2 = bin2_q[BitBits+:WordBits];

  // The bitmaps: one write port, two readers. The word of an insertion is read in its cycle, of both bitmaps, as which of
  // them it is about is known late.
  logic [WordWidth-1:0] stored_bits, new_bits, scan_bits, loaded, above_last;
  logic [2*WordWidth-1:0] words_q;
  logic in_use, known;
  logic [WordBits:0] address;
  logic [WordBits-1:0] load_word;
  logic [BinBits-1:0] last;

  assign in_use = ahead_q ? this_q[word] : later_q[word];
  assign address = {parity_q ^ !ahead_q, word};
  assign known = |(stored_bits & set);
  assign new_bits = stored_bits | set;

  assign stored_bits = address[WordBits] ? words_q[WordWidth+:WordWidth] : words_q[0+:WordWidth];
  for (genvar i = 0; i < 2; i++) begin : gen_bitmap
    logic write, used;
    logic [WordWidth-1:0] read_bits;
    logic [WordBits-1:0] read_word;
    assign write = write_q && address[WordBits] == 1'(i);
    assign read_word = insert_bin_i[BitBits+:WordBits];
    assign used = parity_q == 1'(i) ? this_q[read_word] : later_q[read_word];
    always_ff @(posedge clk_i) begin
      words_q[WordWidth*i+:WordWidth] <= write && word == read_word ? new_bits : used ? read_bits : '0;
    end
    lut_ram #(
        .Width(WordWidth),
        .Depth(Words)
    ) bitmap_insert (
        .clk_i(clk_i),
        .write_i(write),
        .write_address_i(word),
        .write_data_i(new_bits),
        .read_address_i(read_word),
        .read_data_o(read_bits)
    );
  end
  lut_ram #(
      .Width(WordWidth),
      .Depth(2 * Words)
  ) bitmap_scan (
      .clk_i(clk_i),
      .write_i(write_q),
      .write_address_i(address),
      .write_data_i(new_bits),
      .read_address_i({parity_q, load_word}),
      .read_data_o(scan_bits)
  );

  // Packets per bin less one; what stands there counts only while the bin's bit says so. A number is written two cycles
  // after the insertion: one that is read in the cycle of an insertion lacks the insertion before, and what that cycle
  // writes is taken from where it is.
  logic [CountBits-1:0] stored_count, stored_count_q, last_count_q, new_count;
  logic same_count_q, written_q;
  assign new_count = known2_q ? (same_count_q ? last_count_q : stored_count_q) + 1'b1 : '0;
  always_ff @(posedge clk_i) begin
    written_q <= write2_q && bin2_q == insert_bin_i;
    stored_count_q <= written_q ? last_count_q : stored_count;
    same_count_q <= write2_q && bin2_q == bin_q;
    last_count_q <= new_count;
  end

  block_ram #(
      .Width(CountBits),
      .Depth(1 << BinBits)
  ) counts_insert (
      .clk_i(clk_i),
      .write_i(write2_q),
      .write_address_i(bin2_q),
      .write_data_i(new_count),
      .read_i(1'b1),
      .read_address_i(insert_bin_i),
      .read_data_o(stored_count)
  );

  // The numbers of the bins in places 1 and 2 are read in every cycle, and in the next one that of the bin which is then
  // in place 1 is there, where that bin is one of the two. The insertion of the cycle before the read put the bin there
  // (void), or is added to what was read, as are that of the cycle of the read and that of the next one.
  logic [1:0] void_q, forward_q, joined_q, joining_q;
  logic [2*CountBits-1:0] stored_places;
  logic [1:0] second_joins;
  for (genvar i = 0; i < 2; i++) begin : gen_number
    logic joined;
    assign joined = write_q && ahead_q && bin_q == row_q[BinBits*(i+1)+:BinBits];
    always_ff @(posedge clk_i) begin
      void_q[i] <= joined && in_row_q;
      forward_q[i] <= write2_q && bin2_q == row_q[BinBits*(i+1)+:BinBits];
      joined_q[i] <= joined && !in_row_q;
      joining_q[i] <= insert_i && same[i+1];
    end

    block_ram #(
        .Width(CountBits),
        .Depth(1 << BinBits)
    ) counts (
        .clk_i(clk_i),
        .write_i(write2_q),
        .write_address_i(bin2_q),
        .write_data_i(new_count),
        .read_i(1'b1),
        .read_address_i(row_q[BinBits*(i+1)+:BinBits]),
        .read_data_o(stored_places[CountBits*i+:CountBits])
    );
  end
  assign second_joins = 2'(joined_q[move_q]) + 2'(joining_q[move_q]) + 2'(insert_i && same[1]);
  always_ff @(posedge clk_i) begin
    read_q <= move_q ? stored_places[CountBits+:CountBits] : stored_places[0+:CountBits];
    if (void_q[move_q]) read_q <= '0;
    forward2_q <= forward_q[move_q] && !void_q[move_q];
    last2_count_q <= last_count_q;
  end

  // The scan: what it does to its words, and what an insertion beyond the row does to it.
  logic in_word, before_word, behind_word, restart;
  logic append, may_append, emit, bits_any;
  logic [WordWidth-1:0] bits, lowest;
  logic [BitBits-1:0] found_bit;
  logic [BinBits-1:0] found;
  logic candidate_any;
  logic [WordBits-1:0] candidate;
  logic [Words-1:0] words_behind;

  assign in_word = word_valid_q && word2 == word_q;
  assign before_word = word_valid_q && word2 < word_q;
  assign behind_word = !word_valid_q || word2 > word_q;
  assign restart = overflow_q || (fills_q && before_word);

  // The bin on its way waits where one of the last insertions may lie before it: of this cycle's only the word is looked at.
  logic may_precede;
  assign may_precede = insert_i && insert_bin_i[BitBits+:WordBits] <= word_q &&
      (start_q || insert_bin_i[BitBits+:WordBits] >= current_q[BitBits+:WordBits]);
  assign may_append = found_valid_q && !valid_q[Row-1] && !may_precede && !(beyond_q && word <= word_q);
  assign append = may_append && !(fills_q && !behind_word);
  assign bits_any = bits_q != '0;
  assign bits = bits_any ? bits_q : next_bits_q;
  // A carry chain for each word, beside the question which of them it is.
  assign lowest = bits_any ? bits_q & (~bits_q + 1'b1) : next_bits_q & (~next_bits_q + 1'b1);
  // Where an insertion holds the bin on its way back, its word is the scan's, or the scan starts again.
  assign emit = (!found_valid_q || may_append) && (bits_any || next_valid_q) &&
      !(fills_q && (in_word || !bits_any));

  always_comb begin
    found_bit = '0;
    for (int unsigned i = 0; i < WordWidth; i++) begin
      if (found_q[i]) found_bit = found_bit | BitBits'(i);
    end
  end
  assign found = {word_q, found_bit};

  always_comb begin
    for (int unsigned i = 0; i < Words; i++) begin
      words_behind[i] = this_q[i] && (!word_valid_q || WordBits'(i) > word_q);
    end
  end
  lowest_bit #(
      .Width(Words)
  ) of_words (
      .bits_i(words_behind),
      .any_o(candidate_any),
      .index_o(candidate)
  );

  assign last = valid_q[Row-1] ? row_q[BinBits*(Row-1)+:BinBits] : last_q;
  assign load_word = load_q ? last_q[BitBits+:WordBits] : candidate_q;
  always_comb begin
    for (int unsigned i = 0; i < WordWidth; i++) above_last[i] = !load_q || BitBits'(i) > last_q[BitBits-1:0];
  end
  // In use, what the row's last bin put there included: it came two cycles ago at least.
  assign loaded = scan_bits & above_last;
`ifndef SYNTHESIS
  always_ff @(posedge clk_i) if (!rst_i && (load_q || (search_q && candidate_any_q))) assert (this_q[load_word]);
`endif

  // Over when nothing is left to find in this pass.
  logic exhausted, wrap;
  assign exhausted = valid_q == '0 && !found_valid_q && !bits_any && next_none_q;
  assign wrap = take_i && !left_any_q && exhausted && !write_q && !fills_q;

  always_ff @(posedge clk_i) begin
    // The packets of the current bin.
    if (pop) begin
      current_q <= row_q[0+:BinBits];
      start_q   <= 1'b0;
    end
    left_any_q <= hit ||
        (pop ? more != '0 || joins != '0 : left_any_q && !(take_i && left_q == CountBits'(1)));
    left_q <= left;

    write_q  <= insert_i && !hit;
    ahead_q  <= ahead;
    in_row_q <= in_row;
    beyond_q <= beyond;
    bin_q    <= insert_bin_i;
    write2_q <= write_q;
    known2_q <= known;
    fills_q  <= beyond_q && !known;
    bin2_q   <= bin_q;
    set2_q   <= set;
    if (write_q) begin
      if (ahead_q) this_q[word] <= 1'b1;
      else later_q[word] <= 1'b1;
    end

    // The row.
    known1_q <= at[2:0] == '0 && !(append && !valid_q[2]);
    move_q <= move;
    fresh_q <= move ? at[1] : at[0];
    sum_q <= more + CountBits'(joins);
    joins_q <= move ? second_joins : 2'(insert_i && same[0]);
    for (int unsigned i = 0; i < Row; i++) begin
      if (past[i]) begin
        row_q[BinBits*i+:BinBits] <= move ? row_q[BinBits*i+:BinBits] : row_q[BinBits*((i+Row-1)%Row)+:BinBits];
        valid_q[i] <= move ? valid_q[i] : valid_q[(i+Row-1)%Row];
      end else if (put[i]) begin
        row_q[BinBits*i+:BinBits] <= insert_bin_i;
        valid_q[i] <= 1'b1;
      end else if (append && appends[i]) begin
        row_q[BinBits*i+:BinBits] <= found;
        valid_q[i] <= 1'b1;
      end else if (move) begin
        row_q[BinBits*i+:BinBits] <= row_q[BinBits*((i+1)%Row)+:BinBits];
        valid_q[i] <= i + 1 < Row && valid_q[(i+1)%Row];
      end
    end
    if (pop && !move) valid_q[0] <= 1'b0;
    last_q <= append ? found : last;
    if (append) last_valid_q <= 1'b1;

    // The word and the bin that was found in it.
    if (append) found_valid_q <= 1'b0;
    if (emit) begin
      found_valid_q <= 1'b1;
      found_q <= lowest;
      bits_q <= bits & ~lowest;
      if (!bits_any) begin
        word_q <= next_q;
        word_valid_q <= 1'b1;
      end
    end else if (fills_q && in_word) begin
      bits_q <= bits_q | set2_q | (found_valid_q ? found_q : '0);
      found_valid_q <= 1'b0;
    end
    overflow_q <= in_row && !move && valid_q[Row-1];
    load_q <= 1'b0;
    if (load_q) begin
      bits_q <= loaded;
      word_q <= load_word;
      word_valid_q <= 1'b1;
    end

    // The next word.
    search_q <= !load_q && !search_q && !next_valid_q && !next_none_q;
    stale_q <= ahead_q && !in_use;
    candidate_q <= candidate;
    candidate_any_q <= candidate_any;
    if (search_q && !stale_q && !(ahead_q && !in_use)) begin
      next_valid_q <= candidate_any_q;
      next_none_q <= !candidate_any_q;
      next_q <= candidate_q;
      next_bits_q <= loaded;
    end
    if (emit && !bits_any) next_valid_q <= 1'b0;
    if (fills_q && behind_word && (next_valid_q || next_none_q)) begin
      next_valid_q <= 1'b1;
      next_none_q  <= 1'b0;
      if (next_none_q || word2 < next_q) begin
        next_q <= word2;
        next_bits_q <= set2_q;
      end else if (word2 == next_q) begin
        next_bits_q <= next_bits_q | set2_q;
      end
    end

    if (restart) begin
      load_q <= last_valid_q;
      found_valid_q <= 1'b0;
      bits_q <= '0;
      word_valid_q <= 1'b0;
      search_q <= 1'b0;
      next_valid_q <= 1'b0;
      next_none_q <= 1'b0;
    end
    if (wrap) begin
      this_q <= later_q;
      later_q <= '0;
      parity_q <= !parity_q;
      start_q <= 1'b1;
    end
    if (wrap || rst_i || clear_i) begin
      valid_q <= '0;
      known1_q <= 1'b1;
      overflow_q <= 1'b0;
      load_q <= 1'b0;
      last_valid_q <= 1'b0;
      found_valid_q <= 1'b0;
      bits_q <= '0;
      word_valid_q <= 1'b0;
      search_q <= 1'b0;
      next_valid_q <= 1'b0;
      next_none_q <= 1'b0;
    end
    if (rst_i || clear_i) begin
      start_q <= 1'b1;
      left_q  <= '0;
      left_any_q <= 1'b0;
      this_q  <= '0;
      later_q <= '0;
    end
    if (rst_i) begin
      parity_q <= 1'b0;
      write_q  <= 1'b0;
      ahead_q  <= 1'b0;
      beyond_q <= 1'b0;
      write2_q <= 1'b0;
      fills_q  <= 1'b0;
    end
  end
endmodule

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
  // The row: place 0 is the next bin, with its number of packets less one. Places in use follow each other; place 0 may
  // be empty while place 1 waits for its number, which has to be read before it moves up.
  logic [Row-1:0] valid_q;
  logic [Row*BinBits-1:0] row_q;
  logic [CountBits-1:0] more_q;
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
  assign take_ready_o = left_any_q || valid_q[0];
  assign take_alone_o = 1'b0;
  assign bin_o = left_any_q ? current_q : row_q[0+:BinBits];
  assign pop = take_i && !left_any_q && valid_q[0];
  assign move = (pop || !valid_q[0]) && known1_q;

  // Where the new packet's bin lies once the choice is made.
  logic [Row-1:0] below, same;
  logic [Row:0] up;  // belongs at this place or before it, at place 0 only before its bin
  logic above_current, above_first, at_current, hit, ahead, in_row, beyond;
  assign up[Row] = 1'b1;
  for (genvar i = 0; i < Row; i++) begin : gen_compare
    assign below[i] = valid_q[i] && insert_bin_i < row_q[BinBits*i+:BinBits];
    assign same[i]  = valid_q[i] && insert_bin_i == row_q[BinBits*i+:BinBits];
    assign up[i]    = below[i] || (i > 0 && !valid_q[i]);
  end
  assign above_current = start_q || insert_bin_i > current_q;
  assign at_current = !start_q && insert_bin_i == current_q;
  assign above_first = !below[0] && !same[0];
  assign hit = insert_i && (pop ? same[0] : at_current);
  assign ahead = insert_i && (pop ? above_first : above_current);
  assign in_row = ahead && below != '0 && same == '0;
  assign beyond = ahead && below == '0 && same == '0;

  // The insertion a cycle later.
  logic write_q, ahead_q, in_row_q, beyond_q;
  logic [BinBits-1:0] bin_q;
  logic [WordBits-1:0] word;
  logic [BitBits-1:0] bit_number;
  logic [WordWidth-1:0] set;
  assign {word, bit_number} = bin_q;
  assign set = WordWidth'(1) << bit_number;

  // And two cycles later.
  logic write2_q, ahead2_q, in_row2_q, known2_q, fills_q;  // fills_q: fills a bin beyond the row
  logic [BinBits-1:0] bin2_q;
  logic [WordBits-1:0] word2;
  logic [WordWidth-1:0] set2_q;
  assign word2 = bin2_q[BitBits+:WordBits];

  // The bitmaps: one write port, two readers.
  logic [WordWidth-1:0] stored_bits, new_bits, scan_bits, loaded, above_last;
  logic in_use, known;
  logic [WordBits:0] address;
  logic [WordBits-1:0] load_word;
  logic [BinBits-1:0] last;

  assign in_use = ahead_q ? this_q[word] : later_q[word];
  assign address = {parity_q ^ !ahead_q, word};
  assign known = in_use && |(stored_bits & set);
  assign new_bits = (in_use ? stored_bits : '0) | set;

  lut_ram #(
      .Width(WordWidth),
      .Depth(2 * Words)
  ) bitmap_insert (
      .clk_i(clk_i),
      .write_i(write_q),
      .write_address_i(address),
      .write_data_i(new_bits),
      .read_address_i(address),
      .read_data_o(stored_bits)
  );
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

  // Packets per bin less one; what stands there counts only while the bin's bit says so.
  // The insertion one cycle ahead has not been written yet when a count is read.
  logic [CountBits-1:0] stored_count, stored_count_q, last_count_q, second_count, new_count;
  logic same_count_q;
  assign new_count = known2_q ? (same_count_q ? last_count_q : stored_count_q) + 1'b1 : '0;
  always_ff @(posedge clk_i) begin
    stored_count_q <= stored_count;
    same_count_q   <= write2_q && bin2_q == bin_q;
    last_count_q   <= new_count;
  end

  lut_ram #(
      .Width(CountBits),
      .Depth(1 << BinBits)
  ) counts_insert (
      .clk_i(clk_i),
      .write_i(write2_q),
      .write_address_i(bin2_q),
      .write_data_i(new_count),
      .read_address_i(bin_q),
      .read_data_o(stored_count)
  );

  // The number of the bin in place 1: kept from cycle to cycle, or, where it is another bin in the next cycle or not known,
  // read in this one, of place 2 where 1 is known. What the insertions of this cycle and of the last two add to what is
  // read is added then; one that put the bin there makes it void.
  logic [BinBits-1:0] read_bin;
  logic joined, joined2, read_used;
  /* verilator lint_off UNUSEDSIGNAL */  // of a pool of one packet no two
  logic [1:0] joins_q;
  /* verilator lint_on UNUSEDSIGNAL */
  logic [CountBits-1:0] second_count_q, second_more;
  logic unused_carry;
  assign read_bin = known1_q ? row_q[2*BinBits+:BinBits] : row_q[BinBits+:BinBits];
  assign read_used = move || !known1_q;
  assign joined = write_q && ahead_q && bin_q == read_bin;
  assign joined2 = write2_q && ahead2_q && bin2_q == read_bin;
  // One carry chain, the insertion of this cycle its carry in.
  assign {second_more, unused_carry} = {second_count_q, 1'b1} + {CountBits'(joins_q), insert_i && same[1]};
  always_ff @(posedge clk_i) begin
    if (!read_used) begin
      second_count_q <= second_more;
      joins_q <= '0;
    end else begin
      second_count_q <= (joined && in_row_q) || (joined2 && in_row2_q) ? '0 : second_count;
      joins_q <= 2'(joined && !in_row_q) + 2'(joined2 && !in_row2_q) + 2'(insert_i && (known1_q ? same[2] : same[1]));
    end
  end

  lut_ram #(
      .Width(CountBits),
      .Depth(1 << BinBits)
  ) counts_second (
      .clk_i(clk_i),
      .write_i(write2_q),
      .write_address_i(bin2_q),
      .write_data_i(new_count),
      .read_address_i(read_bin),
      .read_data_o(second_count)
  );

  // The scan: what it does to its words, and what an insertion beyond the row does to it.
  logic in_word, before_word, behind_word, restart;
  logic append, emit, bits_any;
  logic [WordWidth-1:0] bits, lowest;
  logic [BitBits-1:0] found_bit;
  logic [BinBits-1:0] found;
  logic candidate_any;
  logic [WordBits-1:0] candidate;
  logic [Words-1:0] words_behind;

  assign in_word = word_valid_q && word2 == word_q;
  assign before_word = word_valid_q && word2 < word_q;
  assign behind_word = !in_word && !before_word;
  assign restart = overflow_q || (fills_q && before_word);

  // The bin on its way waits where one of the last insertions may lie before it: of this cycle's only the word is looked at.
  logic may_precede;
  assign may_precede = insert_i && insert_bin_i[BitBits+:WordBits] <= word_q &&
      (start_q || insert_bin_i[BitBits+:WordBits] >= current_q[BitBits+:WordBits]);
  assign append = found_valid_q && !valid_q[Row-1] && !may_precede && !(beyond_q && word <= word_q) &&
      !(fills_q && !behind_word);
  assign bits_any = bits_q != '0;
  assign bits = bits_any ? bits_q : next_bits_q;
  // A carry chain for each word, beside the question which of them it is.
  assign lowest = bits_any ? bits_q & (~bits_q + 1'b1) : next_bits_q & (~next_bits_q + 1'b1);
  assign emit = (!found_valid_q || append) && (bits_any || next_valid_q) &&
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
    left_any_q <= hit || (pop ? more_q != '0 : left_any_q && !(take_i && left_q == CountBits'(1)));
    left_q <= (pop ? more_q : left_q - CountBits'(take_i && left_any_q)) + CountBits'(hit);

    write_q  <= insert_i && !hit;
    ahead_q  <= ahead;
    in_row_q <= in_row;
    beyond_q <= beyond;
    bin_q    <= insert_bin_i;
    write2_q <= write_q;
    ahead2_q <= ahead_q;
    in_row2_q <= in_row_q;
    known2_q <= known;
    fills_q  <= beyond_q && !known;
    bin2_q   <= bin_q;
    set2_q   <= set;
    if (write_q) begin
      if (ahead_q) this_q[word] <= 1'b1;
      else later_q[word] <= 1'b1;
    end

    // The row.
    known1_q <= !(in_row && up[2]) && !(append && !valid_q[2]);
    if (move) begin
      more_q <= in_row && up[1] ? '0 : second_more;
    end else if (in_row && below[0]) begin
      more_q <= '0;
    end else begin
      more_q <= more_q + CountBits'(insert_i && same[0]);
    end
    for (int unsigned i = 0; i < Row; i++) begin
      if (move) begin
        if (append && i > 0 && (i + 1 == Row || !valid_q[(i+1)%Row]) && (i == 1 || valid_q[i])) begin
          row_q[BinBits*i+:BinBits] <= found;
          valid_q[i] <= 1'b1;
        end else if (in_row && up[i+1]) begin
          if (i == 0 || !up[i]) row_q[BinBits*i+:BinBits] <= insert_bin_i;
          valid_q[i] <= i == 0 || !up[i] || valid_q[i];
        end else begin
          row_q[BinBits*i+:BinBits] <= row_q[BinBits*((i+1)%Row)+:BinBits];
          valid_q[i] <= i + 1 < Row && valid_q[(i+1)%Row];
        end
      end else if (in_row) begin
        if (up[i]) begin
          row_q[BinBits*i+:BinBits] <= i == 0 || !up[(i+Row-1)%Row] ? insert_bin_i : row_q[BinBits*((i+Row-1)%Row)+:BinBits];
          valid_q[i] <= i <= 1 || valid_q[(i+Row-1)%Row];
        end
      end else if (append && i > 0 && !valid_q[i] && valid_q[(i+Row-1)%Row]) begin
        row_q[BinBits*i+:BinBits] <= found;
        valid_q[i] <= 1'b1;
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

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
// The next few bins wait in a sorted row, where an insertion finds its place at once. Behind it reorder_sweep_scan goes
// through the bitmap of this pass; beside it reorder_sweep_counts keeps how many packets a bin holds. The bitmaps learn of
// an insertion a cycle after the row, counts and scan two cycles.
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
  logic append, scan_done;  // a bin for the row comes; none is left in this pass
  logic [BinBits-1:0] found;

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

  logic [CountBits-1:0] more;  // and joins: packets of the bin in place 0 less one
  logic [1:0] joins;

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
  logic [WordWidth-1:0] set2_q;

  // The bitmaps: one write port, two readers. The word of an insertion is read in its cycle, of both bitmaps, as which of
  // them it is about is known late.
  logic [WordWidth-1:0] stored_bits, new_bits, scan_bits;
  logic [2*WordWidth-1:0] words_q;
  logic in_use, known;
  logic [WordBits:0] address;
  logic [WordBits-1:0] scan_word;

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
      .read_address_i({parity_q, scan_word}),
      .read_data_o(scan_bits)
  );

  reorder_sweep_counts #(
      .BinBits(BinBits),
      .CountBits(CountBits)
  ) counts (
      .clk_i(clk_i),
      .insert_bin_i(insert_bin_i),
      .same_i({3{insert_i}} & same[2:0]),
      .at_i(at[1:0]),
      .bin1_i(bin_q),
      .ahead1_i(write_q && ahead_q),
      .in_row1_i(in_row_q),
      .write2_i(write2_q),
      .bin2_i(bin2_q),
      .known2_i(known2_q),
      .places_i(row_q[BinBits+:2*BinBits]),
      .move_i(move),
      .more_o(more),
      .joins_o(joins)
  );

  logic exhausted, wrap;

  reorder_sweep_scan #(
      .BinBits(BinBits)
  ) scan (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .clear_i(wrap || clear_i),
      .words_i(this_q),
      .word_o(scan_word),
      .bits_i(scan_bits),
      .ahead_i(insert_i && (start_q || insert_bin_i[BitBits+:WordBits] >= current_q[BitBits+:WordBits])),
      .ahead_word_i(insert_bin_i[BitBits+:WordBits]),
      .beyond_i(beyond_q),
      .beyond_word_i(word),
      .new_word_i(ahead_q && !in_use),
      .fills_i(fills_q),
      .fills_word_i(bin2_q[BitBits+:WordBits]),
      .fills_set_i(set2_q),
      .row_full_i(valid_q[Row-1]),
      .row_last_i(row_q[BinBits*(Row-1)+:BinBits]),
      .overflow_i(in_row && !move && valid_q[Row-1]),
      .append_o(append),
      .bin_o(found),
      .done_o(scan_done)
  );

  // Over when nothing is left to find in this pass.
  assign exhausted = valid_q == '0 && scan_done;
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
    if (wrap) begin
      this_q <= later_q;
      later_q <= '0;
      parity_q <= !parity_q;
      start_q <= 1'b1;
    end
    if (wrap || rst_i || clear_i) begin
      valid_q <= '0;
      known1_q <= 1'b1;
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

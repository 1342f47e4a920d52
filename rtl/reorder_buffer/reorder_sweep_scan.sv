// SPDX-License-Identifier: Apache-2.0
// The scan of reorder_sweep: goes through the bitmap of this pass, from below upwards, and gives its bins to the row one
// by one. It holds the word it is in, the next word, which is fetched meanwhile, and one bin on its way to the row. An
// insertion that fills a bin beyond the row is put into the words that it holds; where that would be too late, or where
// the row overflows, it starts again after the row's last bin.
//
// One bin a cycle from a word; a word in use follows another after 3 cycles. A bin waits where one of the last two
// insertions may lie before it.
module reorder_sweep_scan #(
    parameter int unsigned BinBits = 9,  // at least 2
    localparam int unsigned BitBits = (BinBits + 1) / 2,
    localparam int unsigned WordBits = BinBits - BitBits,
    localparam int unsigned WordWidth = 1 << BitBits,
    localparam int unsigned Words = 1 << WordBits
) (
    input  logic                 clk_i,
    input  logic                 rst_i,
    input  logic                 clear_i,        // a pass begins
    // the bitmap of the pass: words in use, and the bits of one
    input  logic [    Words-1:0] words_i,
    output logic [ WordBits-1:0] word_o,
    input  logic [WordWidth-1:0] bits_i,
    // an insertion of this cycle may lie ahead of the current bin, in this word
    input  logic                 ahead_i,
    input  logic [ WordBits-1:0] ahead_word_i,
    // that of a cycle ago lies beyond the row, in this word; brings a word into use
    input  logic                 beyond_i,
    input  logic [ WordBits-1:0] beyond_word_i,
    input  logic                 new_word_i,
    // that of two cycles ago fills a bin beyond the row: word, bit
    input  logic                 fills_i,
    input  logic [ WordBits-1:0] fills_word_i,
    input  logic [WordWidth-1:0] fills_set_i,
    // the row
    input  logic                 row_full_i,
    input  logic [  BinBits-1:0] row_last_i,
    input  logic                 overflow_i,     // a bin falls out of it
    output logic                 append_o,       // a bin for it
    output logic [  BinBits-1:0] bin_o,
    output logic                 done_o          // nothing is left to find
);
  logic overflow_q;  // a bin fell out of the row
  logic load_q;  // starts again after the last bin of the row
  logic last_valid_q;  // a bin has entered the row in this pass
  logic [BinBits-1:0] last_q;  // the last bin of the row a cycle ago, or the last that was there
  logic word_valid_q, next_valid_q, next_none_q, search_q, stale_q, candidate_any_q, found_valid_q;
  logic [WordBits-1:0] word_q, next_q, candidate_q;
  logic [WordWidth-1:0] bits_q, next_bits_q;  // what the scan has still to do in its word; all of the next word
  logic [WordWidth-1:0] found_q;  // the bin on its way to the row, in word_q

  // What the scan does to its words, and what an insertion beyond the row does to it.
  logic in_word, before_word, behind_word, restart;
  logic may_append, emit, bits_any;
  logic [WordWidth-1:0] bits, lowest;
  logic [BitBits-1:0] found_bit;
  logic [BinBits-1:0] last;
  logic [WordWidth-1:0] loaded, above_last;
  logic candidate_any;
  logic [WordBits-1:0] candidate;
  logic [Words-1:0] words_behind;

  assign in_word = word_valid_q && fills_word_i == word_q;
  assign before_word = word_valid_q && fills_word_i < word_q;
  assign behind_word = !word_valid_q || fills_word_i > word_q;
  assign restart = overflow_q || (fills_i && before_word);

  // The bin on its way waits where one of the last insertions may lie before it: of this cycle's only the word is looked at.
  logic may_precede;
  assign may_precede = ahead_i && ahead_word_i <= word_q;
  assign may_append = found_valid_q && !row_full_i && !may_precede && !(beyond_i && beyond_word_i <= word_q);
  assign append_o = may_append && !(fills_i && !behind_word);
  assign bits_any = bits_q != '0;
  assign bits = bits_any ? bits_q : next_bits_q;
  // A carry chain for each word, beside the question which of them it is.
  assign lowest = bits_any ? bits_q & (~bits_q + 1'b1) : next_bits_q & (~next_bits_q + 1'b1);
  // Where an insertion holds the bin on its way back, its word is the scan's, or the scan starts again.
  assign emit = (!found_valid_q || may_append) && (bits_any || next_valid_q) &&
      !(fills_i && (in_word || !bits_any));

  always_comb begin
    found_bit = '0;
    for (int unsigned i = 0; i < WordWidth; i++) begin
      if (found_q[i]) found_bit = found_bit | BitBits'(i);
    end
  end
  assign bin_o = {word_q, found_bit};

  always_comb begin
    for (int unsigned i = 0; i < Words; i++) begin
      words_behind[i] = words_i[i] && (!word_valid_q || WordBits'(i) > word_q);
    end
  end
  lowest_bit #(
      .Width(Words)
  ) of_words (
      .bits_i(words_behind),
      .any_o(candidate_any),
      .index_o(candidate)
  );

  assign last = row_full_i ? row_last_i : last_q;
  assign word_o = load_q ? last_q[BitBits+:WordBits] : candidate_q;
  always_comb begin
    for (int unsigned i = 0; i < WordWidth; i++) above_last[i] = !load_q || BitBits'(i) > last_q[BitBits-1:0];
  end
  // In use, what the row's last bin put there included: it came two cycles ago at least.
  assign loaded = bits_i & above_last;
`ifndef SYNTHESIS
  always_ff @(posedge clk_i) if (!rst_i && (load_q || (search_q && candidate_any_q))) assert (words_i[word_o]);
`endif
  assign done_o = !found_valid_q && !bits_any && next_none_q;

  always_ff @(posedge clk_i) begin
    last_q <= append_o ? bin_o : last;
    if (append_o) last_valid_q <= 1'b1;

    // The word and the bin that was found in it.
    if (append_o) found_valid_q <= 1'b0;
    if (emit) begin
      found_valid_q <= 1'b1;
      found_q <= lowest;
      bits_q <= bits & ~lowest;
      if (!bits_any) begin
        word_q <= next_q;
        word_valid_q <= 1'b1;
      end
    end else if (fills_i && in_word) begin
      bits_q <= bits_q | fills_set_i | (found_valid_q ? found_q : '0);
      found_valid_q <= 1'b0;
    end
    overflow_q <= overflow_i;
    load_q <= 1'b0;
    if (load_q) begin
      bits_q <= loaded;
      word_q <= word_o;
      word_valid_q <= 1'b1;
    end

    // The next word.
    search_q <= !load_q && !search_q && !next_valid_q && !next_none_q;
    stale_q <= new_word_i;
    candidate_q <= candidate;
    candidate_any_q <= candidate_any;
    if (search_q && !stale_q && !new_word_i) begin
      next_valid_q <= candidate_any_q;
      next_none_q <= !candidate_any_q;
      next_q <= candidate_q;
      next_bits_q <= loaded;
    end
    if (emit && !bits_any) next_valid_q <= 1'b0;
    if (fills_i && behind_word && (next_valid_q || next_none_q)) begin
      next_valid_q <= 1'b1;
      next_none_q  <= 1'b0;
      if (next_none_q || fills_word_i < next_q) begin
        next_q <= fills_word_i;
        next_bits_q <= fills_set_i;
      end else if (fills_word_i == next_q) begin
        next_bits_q <= next_bits_q | fills_set_i;
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
    if (rst_i || clear_i) begin
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
  end
endmodule

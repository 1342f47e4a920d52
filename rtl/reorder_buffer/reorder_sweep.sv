// SPDX-License-Identifier: Apache-2.0
// Which bin the next packet leaves: sweep. Stays on a bin until it is empty, packets that join meanwhile included, then
// takes the next non-empty bin in cyclic order. One insertion and one choice a cycle, the choice sees the insertion of
// its cycle; passing from the last bin to the first takes 5 cycles in which take_ready_o is 0. Mirrors the sweep of
// golden/unit/reorder_buffer.cpp.
//
// A pass goes through the bins upwards. A packet whose bin lies ahead belongs to this pass, one whose bin lies behind to
// the next. Each pass has its bitmap of non-empty bins, in words of which `this_q` and `later_q` say which are in use;
// bits are never cleared, those at and below the current bin are masked and a word out of use counts as 0. What comes
// next is fetched ahead into registers, and every insertion is put in its place there: the next bin, the rest of its
// word, the next word in use with its bits, and the number of the word after that.
module reorder_sweep #(
    parameter int unsigned BinBits = 9,    // at least 2
    parameter int unsigned CountBits = 12  // of the number of packets held
) (
    input  logic               clk_i,
    input  logic               rst_i,
    input  logic               clear_i,       // the order starts afresh; nothing is held
    output logic               ready_o,
    input  logic               insert_i,      // not while a take waits
    input  logic [BinBits-1:0] insert_bin_i,
    input  logic               take_i,        // held until taken; something is held
    output logic               take_ready_o,
    output logic [BinBits-1:0] bin_o
);
  localparam int unsigned BitBits = (BinBits + 1) / 2;
  localparam int unsigned WordBits = BinBits - BitBits;
  localparam int unsigned WordWidth = 1 << BitBits;
  localparam int unsigned Words = 1 << WordBits;

  typedef enum logic [1:0] {
    Run,
    Wrap,
    FindWord,
    Fetch
  } state_t;

  state_t state_q;
  logic start_q;  // no bin yet in this pass: all bins lie ahead
  logic parity_q;  // which bitmap is this pass's
  logic [BinBits-1:0] current_q;
  logic [CountBits-1:0] left_q;  // packets of the current bin
  logic next_valid_q, word_valid_q, third_valid_q;
  logic [BinBits-1:0] next_q;
  logic [WordWidth-1:0] rest_q, word_bits_q;  // bits above next_q in its word; bits of word_q
  logic [WordBits-1:0] word_q, third_q;  // the next words in use after next_q's
  logic [Words-1:0] this_q, later_q;

  assign ready_o = 1'b1;

  // Where the new packet's bin lies.
  logic [WordBits-1:0] insert_word, next_word;
  logic [BitBits-1:0] insert_bit, next_bit;
  logic hit, ahead, becomes_next;

  assign {insert_word, insert_bit} = insert_bin_i;
  assign {next_word, next_bit} = next_q;
  assign hit = insert_i && !start_q && insert_bin_i == current_q;
  assign ahead = insert_i && (start_q || insert_bin_i > current_q);
  assign becomes_next = ahead && (!next_valid_q || insert_bin_i < next_q);

  // The choice.
  logic stay, take, move;
  assign stay = left_q != '0 || hit;
  assign take_ready_o = state_q == Run && (stay || next_valid_q || ahead);
  assign take = take_i && take_ready_o;
  assign move = take && !stay;
  assign bin_o = stay ? current_q : becomes_next ? insert_bin_i : next_q;

  // The bitmaps: one write port, two readers.
  logic [WordWidth-1:0] insert_bits, third_bits, insert_set;
  logic insert_in_use, insert_known;
  logic [WordBits:0] insert_address;

  assign insert_in_use = ahead ? this_q[insert_word] : later_q[insert_word];
  assign insert_set = WordWidth'(1) << insert_bit;
  assign insert_address = {parity_q ^ !ahead, insert_word};
  assign insert_known = insert_in_use && |(insert_bits & insert_set);

  lut_ram #(
      .Width(WordWidth),
      .Depth(2 * Words)
  ) bitmap_insert (
      .clk_i(clk_i),
      .write_i(insert_i && !hit),
      .write_address_i(insert_address),
      .write_data_i((insert_in_use ? insert_bits : '0) | insert_set),
      .read_address_i(insert_address),
      .read_data_o(insert_bits)
  );
  lut_ram #(
      .Width(WordWidth),
      .Depth(2 * Words)
  ) bitmap_third (
      .clk_i(clk_i),
      .write_i(insert_i && !hit),
      .write_address_i(insert_address),
      .write_data_i((insert_in_use ? insert_bits : '0) | insert_set),
      .read_address_i({parity_q, third_q}),
      .read_data_o(third_bits)
  );

  // Packets per bin; what stands there counts only while the bin's bit says so.
  logic [CountBits-1:0] insert_count, next_count, new_count;
  assign new_count = insert_known ? insert_count + 1'b1 : CountBits'(1);

  lut_ram #(
      .Width(CountBits),
      .Depth(1 << BinBits)
  ) counts_insert (
      .clk_i(clk_i),
      .write_i(insert_i && !hit),
      .write_address_i(insert_bin_i),
      .write_data_i(new_count),
      .read_address_i(insert_bin_i),
      .read_data_o(insert_count)
  );
  lut_ram #(
      .Width(CountBits),
      .Depth(1 << BinBits)
  ) counts_next (
      .clk_i(clk_i),
      .write_i(insert_i && !hit),
      .write_address_i(insert_bin_i),
      .write_data_i(new_count),
      .read_address_i(next_q),
      .read_data_o(next_count)
  );

  // Where a packet beyond the next bin falls.
  logic later, in_rest, in_word, in_third, new_word, new_third;
  assign later = ahead && next_valid_q && insert_bin_i > next_q;
  assign in_rest = later && insert_word == next_word;
  assign in_word = later && word_valid_q && insert_word == word_q;
  assign in_third = later && third_valid_q && insert_word == third_q;
  assign new_word = later && insert_word != next_word && (!word_valid_q || insert_word < word_q);
  assign new_third = later && word_valid_q && insert_word > word_q && (!third_valid_q || insert_word < third_q);

  // The lowest bits of what is in the registers, and the word in use after the third.
  logic [WordWidth-1:0] rest, word_bits, next_set;
  logic rest_any, word_any, beyond_any, beyond_new, after_third_valid;
  logic [BitBits-1:0] rest_bit, word_bit;
  logic [Words-1:0] words_beyond;
  logic [WordBits-1:0] beyond, after_third;

  assign rest = rest_q | (in_rest ? insert_set : '0);
  assign word_bits = word_bits_q | (in_word ? insert_set : '0);
  assign next_set = WordWidth'(1) << next_bit;
  always_comb begin
    for (int unsigned i = 0; i < Words; i++) begin
      words_beyond[i] = this_q[i] && (state_q == FindWord || WordBits'(i) > third_q);
    end
  end

  lowest_bit #(
      .Width(WordWidth)
  ) of_rest (
      .bits_i(rest),
      .any_o(rest_any),
      .index_o(rest_bit)
  );
  lowest_bit #(
      .Width(WordWidth)
  ) of_word (
      .bits_i(word_bits),
      .any_o(word_any),
      .index_o(word_bit)
  );
  lowest_bit #(
      .Width(Words)
  ) of_words (
      .bits_i(words_beyond),
      .any_o(beyond_any),
      .index_o(beyond)
  );
  assign beyond_new = later && insert_word > third_q && (!beyond_any || insert_word < beyond);
  assign after_third_valid = third_valid_q && (beyond_any || beyond_new);
  assign after_third = beyond_new ? insert_word : beyond;

  // A step takes the next bin from the rest of its word or else from the next word.
  logic step, to_word;
  assign step = (move && !becomes_next) || state_q == Fetch;
  assign to_word = step && !rest_any && !new_word;

  logic unused;
  assign unused = &{1'b0, word_any};

  always_ff @(posedge clk_i) begin
    // The packets of the current bin.
    if (move) left_q <= becomes_next ? '0 : next_count + CountBits'(insert_i && insert_bin_i == next_q) - 1'b1;
    else left_q <= left_q + CountBits'(hit) - CountBits'(take);

    if (insert_i && !hit) begin
      if (ahead) this_q[insert_word] <= 1'b1;
      else later_q[insert_word] <= 1'b1;
    end

    if (move) begin
      current_q <= bin_o;
      start_q   <= 1'b0;
    end

    // The next bin and the rest of its word.
    if (step) begin
      next_valid_q <= rest_any || new_word || word_valid_q;
      next_q <= rest_any ? {next_word, rest_bit} : new_word ? insert_bin_i : {word_q, word_bit};
      rest_q <= rest_any ? rest & (rest - 1'b1) : new_word || !word_valid_q ? '0 : word_bits & (word_bits - 1'b1);
    end else if (!move && becomes_next) begin
      next_valid_q <= 1'b1;
      next_q <= insert_bin_i;
      rest_q <= next_valid_q && insert_word == next_word ? rest_q | next_set : '0;
    end else if (!move) begin
      rest_q <= rest;
    end

    // The words after it.
    if (to_word) begin
      if (new_third) begin
        word_valid_q <= 1'b1;
        word_q <= insert_word;
        word_bits_q <= insert_set;
      end else begin
        word_valid_q <= third_valid_q;
        word_q <= third_q;
        word_bits_q <= third_bits | (in_third ? insert_set : '0);
        third_valid_q <= after_third_valid;
        third_q <= after_third;
      end
    end else if (!move && becomes_next && next_valid_q && insert_word != next_word) begin
      word_valid_q <= 1'b1;
      word_q <= next_word;
      word_bits_q <= rest_q | next_set;
      third_valid_q <= word_valid_q;
      third_q <= word_q;
    end else if (new_word && !(step && !rest_any)) begin
      word_valid_q <= 1'b1;
      word_q <= insert_word;
      word_bits_q <= insert_set;
      third_valid_q <= word_valid_q;
      third_q <= word_q;
    end else begin
      word_bits_q <= word_bits;
      if (new_third) begin
        third_valid_q <= 1'b1;
        third_q <= insert_word;
      end
    end

    unique case (state_q)
      Run: if (take_i && !take_ready_o) state_q <= Wrap;
      Wrap: begin
        state_q <= FindWord;
        this_q <= later_q;
        later_q <= '0;
        parity_q <= !parity_q;
        start_q <= 1'b1;
        next_valid_q <= 1'b0;
        rest_q <= '0;
        word_valid_q <= 1'b0;
        third_valid_q <= 1'b0;
      end
      FindWord: begin
        state_q <= Fetch;
        third_valid_q <= beyond_any;
        third_q <= beyond;
      end
      default: if (word_valid_q) state_q <= Run;
    endcase

    if (rst_i || clear_i) begin
      state_q <= Run;
      start_q <= 1'b1;
      left_q <= '0;
      next_valid_q <= 1'b0;
      rest_q <= '0;
      word_valid_q <= 1'b0;
      third_valid_q <= 1'b0;
      this_q <= '0;
      later_q <= '0;
    end
    if (rst_i) parity_q <= 1'b0;
  end
endmodule

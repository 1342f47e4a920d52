// SPDX-License-Identifier: Apache-2.0
// Which bin the next packet leaves: sweep. Stays on a bin until it is empty, packets that join meanwhile included, then
// takes the next non-empty bin in cyclic order. One insertion and one choice a cycle, the choice sees the insertion of
// its cycle; passing from the last bin to the first takes 4 cycles in which take_ready_o is 0. Mirrors the sweep of
// golden/unit/reorder_buffer.cpp.
//
// A pass goes through the bins upwards. A packet whose bin lies ahead belongs to this pass, one whose bin lies behind to
// the next. Each pass has its bitmap of non-empty bins, in words of which `this_q` and `later_q` say which are in use;
// bits are never cleared, those at and below the current bin are masked and a word out of use counts as 0. The next bin
// and the next word after it are kept in registers, so that a choice is one compare and the search runs beside it.
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
    LoadWord,
    LoadBin
  } state_t;

  state_t state_q;
  logic start_q;  // no bin yet in this pass: all bins lie ahead
  logic parity_q;  // which bitmap is this pass's
  logic [BinBits-1:0] current_q, next_q;
  logic [CountBits-1:0] left_q;  // packets of the current bin
  logic next_valid_q, word_valid_q;
  logic [WordBits-1:0] word_q;  // the next word in use after next_q's
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

  // The bitmaps: one write port, three readers.
  logic [WordWidth-1:0] insert_bits, next_bits, word_bits, insert_set;
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
  ) bitmap_next (
      .clk_i(clk_i),
      .write_i(insert_i && !hit),
      .write_address_i(insert_address),
      .write_data_i((insert_in_use ? insert_bits : '0) | insert_set),
      .read_address_i({parity_q, next_word}),
      .read_data_o(next_bits)
  );
  lut_ram #(
      .Width(WordWidth),
      .Depth(2 * Words)
  ) bitmap_word (
      .clk_i(clk_i),
      .write_i(insert_i && !hit),
      .write_address_i(insert_address),
      .write_data_i((insert_in_use ? insert_bits : '0) | insert_set),
      .read_address_i({parity_q, word_q}),
      .read_data_o(word_bits)
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

  // What follows next_q, from the registers alone: another bit of its word, or the lowest of the next word in use.
  logic [WordWidth-1:0] above_bits;
  logic [Words-1:0] above_words;
  logic same_word, other_word, word_any;
  logic [BitBits-1:0] same_bit, other_bit;
  logic [WordBits-1:0] other_index;

  assign above_bits = next_bits & ~((WordWidth'(2) << next_bit) - 1'b1);
  assign above_words = state_q == LoadWord ? this_q : this_q & ~((Words'(2) << word_q) - 1'b1);

  lowest_bit #(
      .Width(WordWidth)
  ) in_same_word (
      .bits_i(above_bits),
      .any_o(same_word),
      .index_o(same_bit)
  );
  lowest_bit #(
      .Width(WordWidth)
  ) in_next_word (
      .bits_i(word_bits),
      .any_o(word_any),
      .index_o(other_bit)
  );
  lowest_bit #(
      .Width(Words)
  ) of_words (
      .bits_i(above_words),
      .any_o(other_word),
      .index_o(other_index)
  );

  logic after_valid, after_word_valid, insert_later;
  logic [BinBits-1:0] after;
  logic [WordBits-1:0] after_word_of, after_word;
  assign after_valid = same_word || word_valid_q;
  assign after = same_word ? {next_word, same_bit} : {word_q, other_bit};
  assign after_word_of = same_word ? next_word : word_q;
  assign after_word_valid = same_word ? word_valid_q : word_valid_q && other_word;
  assign after_word = same_word ? word_q : other_index;
  assign insert_later = ahead && !becomes_next && insert_bin_i != next_q;

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

    if (move && !becomes_next) begin
      // Step on; a bin that came just now may lie before what was found.
      next_valid_q <= after_valid || insert_later;
      next_q <= after;
      word_valid_q <= after_word_valid;
      word_q <= after_word;
      if (insert_later) begin
        if (!after_valid || insert_bin_i < after) begin
          next_q <= insert_bin_i;
          if (!after_valid) begin
            word_valid_q <= 1'b0;
          end else if (after_word_of != insert_word) begin
            word_valid_q <= 1'b1;
            word_q <= after_word_of;
          end
        end else if (insert_word != after_word_of && (!after_word_valid || insert_word < after_word)) begin
          word_valid_q <= 1'b1;
          word_q <= insert_word;
        end
      end
    end else if (!move && becomes_next) begin
      next_valid_q <= 1'b1;
      next_q <= insert_bin_i;
      if (next_valid_q && next_word != insert_word) begin
        word_valid_q <= 1'b1;
        word_q <= next_word;
      end
    end else if (!move && insert_later) begin
      if (insert_word != next_word && (!word_valid_q || insert_word < word_q)) begin
        word_valid_q <= 1'b1;
        word_q <= insert_word;
      end
    end

    unique case (state_q)
      Run: if (take_i && !take_ready_o) state_q <= Wrap;
      Wrap: begin
        state_q <= LoadWord;
        this_q <= later_q;
        later_q <= '0;
        parity_q <= !parity_q;
        start_q <= 1'b1;
        next_valid_q <= 1'b0;
        word_valid_q <= 1'b0;
      end
      LoadWord: begin
        state_q <= LoadBin;
        word_q  <= other_index;
      end
      default: begin
        state_q <= Run;
        next_valid_q <= 1'b1;
        next_q <= {word_q, other_bit};
        word_valid_q <= other_word;
        word_q <= other_index;
      end
    endcase

    if (rst_i || clear_i) begin
      state_q <= Run;
      start_q <= 1'b1;
      left_q <= '0;
      next_valid_q <= 1'b0;
      word_valid_q <= 1'b0;
      this_q <= '0;
      later_q <= '0;
    end
    if (rst_i) parity_q <= 1'b0;
  end
endmodule

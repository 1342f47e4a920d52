// SPDX-License-Identifier: Apache-2.0
// The line memory of a cache, and the assembly of its lines from beats. A line is Items items of ItemBytes bytes; only
// the low ItemBits of each are kept. Beats of a line come in order and not interleaved, the first bytes first; its
// place is asked for by the number of its entry, in the cycle in which a part of it is written. filled_o: that was the last.
//
// A part is read in the cycle after its address, straight from block RAM, Items / Parts items. Where a part is whole
// beats, the memory is one part wide; else one line, with a choice behind it. A beat and a part a cycle; a part is
// written in the cycle after its last beat. HeaderBits of each item above the ItemBits lie in a memory of their own, those
// of a line in a word, which is written with the line's last part and read with every part.
//
// With Parity a word has a bit more, written so that the word's bits are even in number, or odd if a beat came with its
// highest bit set: it was not read right where it comes from. read_wrong_o: what was there in the cycle before is odd.
module cache_lines #(
    parameter int unsigned Items = 8,
    parameter int unsigned ItemBytes = 16,
    parameter int unsigned ItemBits = 96,
    parameter int unsigned HeaderBits = 0,
    parameter int unsigned Parts = 2,
    parameter int unsigned BeatBits = 128,
    parameter int unsigned Parity = 0,
    parameter int unsigned EntryBits = 3,
    parameter int unsigned PlaceBits = 7,
    localparam int unsigned PartBits = Parts > 1 ? $clog2(Parts) : 1,
    localparam int unsigned DataBits = Items / Parts * ItemBits,
    localparam int unsigned LineHeaderBits = HeaderBits > 0 ? Items * HeaderBits : 1
) (
    input  logic                 clk_i,
    input  logic                 rst_i,
    // beats
    input  logic                 in_valid_i,
    input  logic [EntryBits-1:0] in_entry_i,
    input  logic [BeatBits+Parity-1:0] in_data_i,  // with parity the highest bit: not read right
    // where a part is written
    output logic [EntryBits-1:0] fill_entry_o,
    input  logic [PlaceBits-1:0] fill_place_i,
    output logic                 filled_o,
    // a part is read, and there in the next cycle
    input  logic [PlaceBits-1:0] read_place_i,
    input  logic [ PartBits-1:0] read_part_i,
    output logic [ PartBits-1:0] read_part_o,
    output logic [ DataBits-1:0] read_data_o,
    output logic [LineHeaderBits-1:0] read_header_o,
    output logic                 read_wrong_o   // a cycle later
);
  localparam int unsigned LineBits = Items * ItemBytes * 8;
  localparam int unsigned Beats = (LineBits + BeatBits - 1) / BeatBits;
  localparam int unsigned BeatCountBits = Beats > 1 ? $clog2(Beats) : 1;
  localparam int unsigned PartLineBits = LineBits / Parts;
  localparam bit Narrow = PartLineBits % BeatBits == 0;
  localparam int unsigned RawBits = Narrow ? PartLineBits : Beats * BeatBits;
  localparam int unsigned RawItems = Narrow ? Items / Parts : Items;
  localparam int unsigned PartBeats = Narrow ? PartLineBits / BeatBits : Beats;

  logic fill_q, fill_last;
  logic [BeatCountBits-1:0] beat_q;
  logic [PartBits-1:0] fill_part_q;
  /* verilator lint_off UNUSEDSIGNAL */  // the padding of items and line
  logic [RawBits-1:0] raw_q;
  /* verilator lint_on UNUSEDSIGNAL */
  logic [RawItems*ItemBits-1:0] fill_data;
  localparam int unsigned RamBits = RawItems * ItemBits;
  logic [RamBits+Parity-1:0] fill_word, read_word;

  for (genvar item = 0; item < RawItems; item++) begin : gen_item
    assign fill_data[ItemBits*item+:ItemBits] = raw_q[ItemBytes*8*item+:ItemBits];
  end

  always_ff @(posedge clk_i) begin
    fill_q <= in_valid_i && beat_q == BeatCountBits'(PartBeats - 1);
    fill_entry_o <= in_entry_i;
    if (in_valid_i) begin
      raw_q <= RawBits'({in_data_i[BeatBits-1:0], raw_q} >> BeatBits);
      beat_q <= beat_q == BeatCountBits'(PartBeats - 1) ? '0 : beat_q + 1'b1;
    end
    read_part_o <= read_part_i;
    if (fill_q) fill_part_q <= fill_last ? '0 : fill_part_q + 1'b1;
    if (rst_i) begin
      fill_q <= 1'b0;
      beat_q <= '0;
      fill_part_q <= '0;
    end
  end
  assign fill_last = !Narrow || Parts == 1 || fill_part_q == PartBits'(Parts - 1);
  assign filled_o = fill_q && fill_last;

  // ---- parity ----
  logic part_bad, line_bad;  // a beat of what is written was not read right
  logic data_wrong, header_wrong;
  if (Parity != 0) begin : gen_parity
    logic part_bad_q, earlier_bad_q;
    always_ff @(posedge clk_i) begin
      if (in_valid_i) part_bad_q <= in_data_i[BeatBits+Parity-1] || (part_bad_q && beat_q != '0);
      if (fill_q) earlier_bad_q <= line_bad && !fill_last;
      if (rst_i) earlier_bad_q <= 1'b0;
    end
    assign part_bad  = part_bad_q;
    assign line_bad  = part_bad_q || earlier_bad_q;
    assign fill_word = {^fill_data ^ part_bad, fill_data};
    parity_check #(
        .Width(RamBits + 1)
    ) check (
        .clk_i(clk_i),
        .word_i(read_word),
        .wrong_o(data_wrong)
    );
  end else begin : gen_no_parity
    assign {part_bad, line_bad, data_wrong} = '0;
    assign fill_word = fill_data;
    /* verilator lint_off UNUSEDSIGNAL */
    logic unused;
    /* verilator lint_on UNUSEDSIGNAL */
    assign unused = part_bad || line_bad;
  end
  assign read_wrong_o = data_wrong || header_wrong;

  if (HeaderBits > 0) begin : gen_header
    localparam int unsigned PartHeaderBits = RawItems * HeaderBits;
    logic [LineHeaderBits-1:0] header;
    logic [LineHeaderBits+Parity-1:0] header_word, read_header_word;
    logic [PartHeaderBits-1:0] fill_header;
    for (genvar item = 0; item < RawItems; item++) begin : gen_part_of_it
      assign fill_header[HeaderBits*item+:HeaderBits] = raw_q[ItemBytes*8*item+ItemBits+:HeaderBits];
    end
    if (Narrow && Parts > 1) begin : gen_gather
      logic [LineHeaderBits-PartHeaderBits-1:0] earlier_q;  // of the parts before
      always_ff @(posedge clk_i) if (fill_q) earlier_q <= (LineHeaderBits - PartHeaderBits)'(header >> PartHeaderBits);
      assign header = {fill_header, earlier_q};
    end else begin : gen_whole
      assign header = fill_header;
    end
    if (Parity != 0) begin : gen_header_parity
      assign header_word = {^header ^ line_bad, header};
      parity_check #(
          .Width(LineHeaderBits + 1)
      ) check (
          .clk_i(clk_i),
          .word_i(read_header_word),
          .wrong_o(header_wrong)
      );
    end else begin : gen_no_header_parity
      assign header_word  = header;
      assign header_wrong = 1'b0;
    end
    assign read_header_o = read_header_word[LineHeaderBits-1:0];
    block_ram #(
        .Width(LineHeaderBits + Parity),
        .Depth(1 << PlaceBits)
    ) headers (
        .clk_i(clk_i),
        .write_i(filled_o),
        .write_address_i(fill_place_i),
        .write_data_i(header_word),
        .read_i(1'b1),
        .read_address_i(read_place_i),
        .read_data_o(read_header_word)
    );
  end else begin : gen_no_header
    assign read_header_o = '0;
    assign header_wrong  = 1'b0;
    /* verilator lint_off UNUSEDSIGNAL */
    logic unused;
    /* verilator lint_on UNUSEDSIGNAL */
    assign unused = line_bad;
  end

  if (Narrow && Parts > 1) begin : gen_part_wide
    block_ram #(
        .Width(RamBits + Parity),
        .Depth(1 << (PlaceBits + PartBits))
    ) lines (
        .clk_i(clk_i),
        .write_i(fill_q),
        .write_address_i({fill_place_i, fill_part_q}),
        .write_data_i(fill_word),
        .read_i(1'b1),
        .read_address_i({read_place_i, read_part_i}),
        .read_data_o(read_word)
    );
    assign read_data_o = read_word[DataBits-1:0];
  end else begin : gen_line_wide
    block_ram #(
        .Width(RamBits + Parity),
        .Depth(1 << PlaceBits)
    ) lines (
        .clk_i(clk_i),
        .write_i(fill_q),
        .write_address_i(fill_place_i),
        .write_data_i(fill_word),
        .read_i(1'b1),
        .read_address_i(read_place_i),
        .read_data_o(read_word)
    );
    if (Parts > 1) begin : gen_choice
      assign read_data_o = read_word[DataBits*read_part_o+:DataBits];
    end else begin : gen_all
      assign read_data_o = read_word[DataBits-1:0];
    end
  end
endmodule

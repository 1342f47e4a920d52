// SPDX-License-Identifier: Apache-2.0
// Photon lines in block RAM, shared by Gatherers gatherers: both maps behind one another (docs/photon_memory.md). The memory
// has two read ports, a beat a cycle each; gatherers of even number share one, those of odd number the other, in turn. Where
// the beats of a line are stored side by side, a port reads a line a cycle, and each gatherer's beats leave by themselves. There,
// with trees of two nodes a cycle, so that no tree binds, the last of an odd number of gatherers uses both ports, a line from
// each in turn, so that both have as much to do.
// Where beats hold whole photons, a plain one takes only its PhotonBits.
//
// Line ports are those of photon_gatherer, side by side, gatherer 0 lowest: a reply is the line's beats in order, one a
// cycle, always taken. Latency from a request to its first beat 4 cycles where nobody else asks; 3, for all gatherers, where one uses
// both ports and there is one map.
//
// Words of 32 bits are written at word addresses of the lines, global map first, then the caustic one, without gaps, while
// no query is in flight; words behind the last line are taken and dropped. Some 5 cycles a word, 32 where neither a line's
// words nor a beat's are a power of two.
//
// With photonloom_pkg::Parity each stored beat has a parity bit. A beat of a reply has one bit more, the highest: the stored
// one is not right, or the line asked for is beyond its map.
module photon_ram #(
    parameter int unsigned Gatherers = photonloom_pkg::Gatherers,
    parameter int unsigned BeatBits = photonloom_pkg::LineBeatBits,
    localparam int unsigned TagBits = photonloom_pkg::LineTagBits,
    localparam int unsigned LineBits = photonloom_pkg::LineAddressBits,
    localparam int unsigned Parity = photonloom_pkg::Parity,
    localparam int unsigned ReplyBits = BeatBits + Parity
) (
    input  logic                              clk_i,
    input  logic                              rst_i,
    input  logic [             Gatherers-1:0] line_req_valid_i,
    output logic [             Gatherers-1:0] line_req_ready_o,
    input  logic [Gatherers*(LineBits+1)-1:0] line_req_addr_i,
    input  logic [     Gatherers*TagBits-1:0] line_req_tag_i,
    output logic [             Gatherers-1:0] line_rsp_valid_o,
    output logic [     Gatherers*TagBits-1:0] line_rsp_tag_o,
    output logic [   Gatherers*ReplyBits-1:0] line_rsp_data_o,
    // words of the lines
    input  logic                              write_valid_i,
    output logic                              write_ready_o,
    input  logic [                      27:0] write_address_i,
    input  logic [                      31:0] write_data_i,
    output logic                              ready_o,          // lines can be read and written: always
    // counted since reset
    output logic [                      39:0] count_lines_o,  // lines served
    output logic [                      39:0] count_busy_o,   // cycles in which a port was reading
    output logic [                      31:0] count_faults_o  // beats that were not right or of no line
);
  localparam int unsigned Bucket = photonloom_pkg::Bucket;
  localparam int unsigned StrideBits = 8 * photonloom_pkg::PhotonBytes;
  localparam int unsigned LineWords = Bucket * StrideBits / 32;
  localparam int unsigned Beats = Bucket * StrideBits / BeatBits;
  localparam int unsigned BeatNumberBits = Beats > 1 ? $clog2(Beats) : 1;
  localparam int unsigned BeatWords = BeatBits / 32;
  localparam int unsigned GlobalLines = photonloom_pkg::GlobalMemoryLines;
  localparam int unsigned CausticLines = photonloom_pkg::CausticMemoryLines;
  localparam int unsigned Lines = GlobalLines + CausticLines > 1 ? GlobalLines + CausticLines : 1;
  localparam int unsigned Depth = Lines * Beats;
  localparam int unsigned Ports = Gatherers > 1 ? 2 : 1;

  // A stored beat: what a slot has beside padding, it holds whole slots, else all of it.
  localparam bit Whole = BeatBits % StrideBits == 0;
  localparam int unsigned Items = Whole ? BeatBits / StrideBits : 1;
  localparam int unsigned ItemBits = Whole ? photonloom_pkg::RecordBits + photonloom_pkg::SlotHeaderBits : BeatBits;
  localparam int unsigned ItemStride = Whole ? StrideBits : BeatBits;
  localparam int unsigned Width = Items * ItemBits;
  localparam int unsigned StoredBits = Width + Parity;

  // 2,049 to 4,096 beats would be pairs of block RAMs of 2,048 words of 9 bits behind one another, of which nextpnr's static placer
  // makes none legal (docs/headline.md). Few beats a line stand side by side instead, a line a row; others are three or four
  // times as many words of 18 bits.
  localparam int unsigned BankWords = 1024;
  localparam bit Pairs = Depth > 2 * BankWords && Depth <= 4 * BankWords;
  localparam bit Rows = Pairs && Beats > 1 && Beats <= 4;
  localparam int unsigned Banks = Pairs && !Rows ? (Depth + BankWords - 1) / BankWords : 1;
  localparam int unsigned RowBeats = Rows ? Beats : 1;
  localparam int unsigned RowBits = RowBeats * StoredBits;
  localparam int unsigned Senders = Rows ? Gatherers : 2;
  localparam bit Both = Rows && Ports == 2 && Gatherers % 2 == 1 && photonloom_pkg::NodesPerCycle > 1;  // the last one uses both ports
  localparam bit AtOnce = Both && (GlobalLines == 0 || CausticLines == 0);  // a line is its row's address
  localparam int unsigned RowsALine = Beats / RowBeats;
  localparam int unsigned AddressBits = Depth / RowBeats > 1 ? $clog2(Depth / RowBeats) : 1;

  // Words are written by lines where the address of a line's first beat is only wires, else by beats, whose number is their address.
  localparam bit ByLines = (RowsALine & (RowsALine - 1)) == 0 || BeatWords == 1;
  localparam int unsigned WriteBeats = ByLines ? Beats : 1;
  localparam int unsigned WriteWords = ByLines ? LineWords : BeatWords;
  localparam int unsigned WordBits = $clog2(WriteWords);
  localparam int unsigned WaitBits = Rows ? 3 : 2;

  if (Beats * BeatBits != Bucket * StrideBits || BeatBits % 32 != 0) begin : gen_bad_beat
    gatherer_beat_bits_must_be_words_of_32_bits_and_divide_the_line bad_beat ();
  end

  assign ready_o = 1'b1;

  // ---- a word to write: its beat is read through port a, changed, and written back ----
  logic write_valid, write_back, write_inside;
  logic [WaitBits-1:0] write_wait_q;
  logic [27:0] write_line;
  logic [WordBits-1:0] write_word;
  logic [31:0] write_data;
  logic [BeatNumberBits-1:0] write_beat;
  logic [BeatWords-1:0] write_here;
  logic [AddressBits-1:0] write_address;
  logic [BeatBits-1:0] read_raw;
  /* verilator lint_off UNUSEDSIGNAL */  // a photon's padding is not kept
  logic [BeatBits-1:0] write_raw;
  /* verilator lint_on UNUSEDSIGNAL */
  logic [Width-1:0] write_packed;
  logic [StoredBits-1:0] write_stored;
  /* verilator lint_off UNUSEDSIGNAL */  // only rows have it
  /* verilator lint_off UNDRIVEN */
  logic [RowBeats-1:0] row_write_q;
  /* verilator lint_on UNDRIVEN */
  /* verilator lint_on UNUSEDSIGNAL */

  photon_word_address #(
      .AddressBits(28),
      .LineWords(WriteWords)
  ) word_address (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(write_valid_i),
      .in_ready_o(write_ready_o),
      .in_address_i(write_address_i),
      .in_data_i(write_data_i),
      .out_valid_o(write_valid),
      .out_taken_i(write_back),
      .out_line_o(write_line),
      .out_word_o(write_word),
      .out_data_o(write_data)
  );

  // Address in cycle 0, word in the memory's output in 1, in the port's register in 2, written back then; of a row beat n as
  // many cycles later.
  assign write_inside = 32'(write_line) < Depth / WriteBeats;
  if (Rows) begin : gen_row_write
    // Known a cycle ahead: to which beat's memory, and that a word goes back, also to none.
    logic write_soon, write_back_q;
    assign write_soon = write_valid && write_wait_q == WaitBits'(1) + WaitBits'(write_beat);
    always_ff @(posedge clk_i) begin
      write_back_q <= write_soon;
      for (int unsigned beat = 0; beat < RowBeats; beat++)
        row_write_q[beat] <= write_soon && write_inside && write_beat == BeatNumberBits'(beat);
      if (rst_i) begin
        write_back_q <= 1'b0;
        row_write_q  <= '0;
      end
    end
    assign write_back = write_back_q;
  end else begin : gen_beat_write
    assign write_back = write_valid && write_wait_q == 2'd2;
  end
  // Comparisons, since a division by BeatWords would be a divider.
  always_comb begin
    write_beat = '0;
    write_here = '0;
    for (int unsigned beat = 0; beat < WriteBeats; beat++)
      for (int unsigned word = 0; word < BeatWords; word++)
        if (32'(write_word) == beat * BeatWords + word) begin
          write_beat = write_beat | BeatNumberBits'(beat);
          write_here[word] = 1'b1;
        end
  end
  assign write_address = AddressBits'(Rows ? 32'(write_line) : 32'(write_line) * WriteBeats + 32'(write_beat));
  always_ff @(posedge clk_i) begin
    write_wait_q <= write_back ? '0 : write_valid ? write_wait_q + 1'b1 : '0;
    if (rst_i) write_wait_q <= '0;
  end
  for (genvar word = 0; word < BeatWords; word++) begin : gen_word
    assign write_raw[32*word+:32] = write_here[word] ? write_data : read_raw[32*word+:32];
  end
  for (genvar item = 0; item < Items; item++) begin : gen_pack
    assign write_packed[ItemBits*item+:ItemBits] = write_raw[ItemStride*item+:ItemBits];
  end

  if (Parity != 0) begin : gen_parity
    assign write_stored = {^write_packed, write_packed};
  end else begin : gen_no_parity
    assign write_stored = write_packed;
  end

  // ---- read ports ----
  logic [2*AddressBits-1:0] read_address;
  logic [1:0] reading, last_beat;
  logic [2*RowBits-1:0] read_data;
  logic [Senders-1:0] faulty;  // a beat on its way out
  /* verilator lint_off UNUSEDSIGNAL */  // nobody is at the second port of one gatherer
  logic [Senders*BeatBits-1:0] raw;
  /* verilator lint_on UNUSEDSIGNAL */

  if (Rows) begin : gen_rows
    // Beat n of a row is read n cycles after its first, so that it comes when the one ahead of it has left.
    logic [AddressBits-1:0] a_address, b_address;
    logic [(RowBeats-1)*AddressBits-1:0] a_later_q, b_later_q;
    assign a_address = write_valid ? write_address : read_address[0+:AddressBits];
    assign b_address = read_address[AddressBits+:AddressBits];
    always_ff @(posedge clk_i) begin
      a_later_q <= ((RowBeats - 1) * AddressBits)'({a_later_q, a_address});
      b_later_q <= ((RowBeats - 1) * AddressBits)'({b_later_q, b_address});
    end
    for (genvar beat = 0; beat < RowBeats; beat++) begin : gen_beat
      block_ram_two_reads #(
          .Width(StoredBits),
          .Depth(Depth / RowBeats)
      ) store (
          .clk_i(clk_i),
          .a_write_i(row_write_q[beat]),
          .a_write_data_i(write_stored),
          .a_read_i(!write_back),
          .a_address_i(AddressBits'({a_later_q, a_address} >> AddressBits * beat)),
          .a_read_data_o(read_data[StoredBits*beat+:StoredBits]),
          .b_read_i(1'b1),
          .b_address_i(AddressBits'({b_later_q, b_address} >> AddressBits * beat)),
          .b_read_data_o(read_data[RowBits+StoredBits*beat+:StoredBits])
      );
    end
  end else if (Banks == 1) begin : gen_one
    block_ram_two_reads #(
        .Width(StoredBits),
        .Depth(Depth)
    ) store (
        .clk_i(clk_i),
        .a_write_i(write_back && write_inside),
        .a_write_data_i(write_stored),
        .a_read_i(!write_back),
        .a_address_i(write_valid ? write_address : read_address[0+:AddressBits]),
        .a_read_data_o(read_data[0+:StoredBits]),
        .b_read_i(1'b1),
        .b_address_i(read_address[AddressBits+:AddressBits]),
        .b_read_data_o(read_data[StoredBits+:StoredBits])
    );
  end else begin : gen_banks
    localparam int unsigned WithinBits = $clog2(BankWords);
    localparam int unsigned BankBits = AddressBits - WithinBits;
    logic [AddressBits-1:0] a_address, b_address;
    logic [BankBits-1:0] a_bank_q, b_bank_q;
    logic [StoredBits-1:0] a_words[0:Banks-1], b_words[0:Banks-1];

    assign a_address = write_valid ? write_address : read_address[0+:AddressBits];
    assign b_address = read_address[AddressBits+:AddressBits];
    always_ff @(posedge clk_i) begin
      a_bank_q <= a_address[WithinBits+:BankBits];
      b_bank_q <= b_address[WithinBits+:BankBits];
    end
    for (genvar bank = 0; bank < Banks; bank++) begin : gen_bank
      block_ram_two_reads #(
          .Width(StoredBits),
          .Depth(BankWords)
      ) store (
          .clk_i(clk_i),
          .a_write_i(write_back && write_inside && a_address[WithinBits+:BankBits] == BankBits'(bank)),
          .a_write_data_i(write_stored),
          .a_read_i(!write_back),
          .a_address_i(a_address[0+:WithinBits]),
          .a_read_data_o(a_words[bank]),
          .b_read_i(1'b1),
          .b_address_i(b_address[0+:WithinBits]),
          .b_read_data_o(b_words[bank])
      );
    end
    assign read_data = {b_words[b_bank_q], a_words[a_bank_q]};
  end
  assign read_raw = raw[0+:BeatBits];

  // Of the gatherer at both ports, by port: its line waits there, starts, was started within the last beats, is read; and of
  // what is read the tag, and that it is beyond its map.
  /* verilator lint_off UNUSEDSIGNAL */  // mostly nobody is
  logic [1:0] both_valid, both_ready, both_waits, both_starts, both_sending, both_read, both_beyond;
  logic [2*TagBits-1:0] both_tag;
  /* verilator lint_on UNUSEDSIGNAL */
  if (Both) begin : gen_both
    // It stays with a port until that has taken its line, so that no arbiter passes it over twice.
    logic next_q;
    assign both_valid = {next_q, !next_q} & {2{line_req_valid_i[Gatherers-1]}};
    assign line_req_ready_o[Gatherers-1] = both_ready != '0;
    always_ff @(posedge clk_i) begin
      if (both_ready != '0) next_q <= !next_q;
      if (rst_i) next_q <= 1'b0;
    end
  end else begin : gen_not_both
    assign {both_valid, both_ready, both_waits, both_starts, both_sending, both_read, both_beyond, both_tag} = '0;
  end

  for (genvar port = 0; port < 2; port++) begin : gen_port
    case (port >= Ports ? 0 : Rows ? 2 : 1)
      1: begin : gen_used  // reads a beat a cycle
        localparam int unsigned Group = (Gatherers - port + Ports - 1) / Ports;
        localparam int unsigned SourceBits = Group > 1 ? $clog2(Group) : 1;
        logic [Group-1:0] req_valid, req_ready;
        logic [Group*(LineBits+1+TagBits)-1:0] req;
        logic ask_valid, ask_ready;
        logic [LineBits+TagBits:0] ask;
        logic [SourceBits-1:0] ask_source;
        logic [TagBits-1:0] ask_tag, tag_q, read_tag_q, out_tag_q;
        logic [LineBits:0] ask_line;
        logic [Group-1:0] target_q, read_target_q, out_target_q;
        logic [AddressBits-1:0] address_q;
        logic [BeatNumberBits-1:0] beat_q;
        logic busy_q;
        logic [StoredBits-1:0] data_q;
        logic wrong;

        for (genvar g = 0; g < Group; g++) begin : gen_gatherer
          localparam int unsigned I = port + Ports * g;
          assign req_valid[g] = line_req_valid_i[I];
          assign line_req_ready_o[I] = req_ready[g];
          assign req[(LineBits+1+TagBits)*g+:LineBits+1+TagBits] = {
            line_req_addr_i[(LineBits+1)*I+:LineBits+1], line_req_tag_i[TagBits*I+:TagBits]
          };
        end

        arbiter #(
            .Inputs(Group),
            .Width(LineBits + 1 + TagBits)
        ) turns (
            .clk_i(clk_i),
            .rst_i(rst_i),
            .in_valid_i(req_valid),
            .in_ready_o(req_ready),
            .in_i(req),
            .out_valid_o(ask_valid),
            .out_ready_i(ask_ready),
            .out_o(ask),
            .out_source_o(ask_source)
        );
        assign {ask_line, ask_tag} = ask;

        // A word to write takes port a, which then starts no line; one that it was reading is not needed by anybody, since
        // lines change only while no query is in flight.
        assign read_address[AddressBits*port+:AddressBits] = address_q;
        assign last_beat[port] = beat_q == BeatNumberBits'(Beats - 1);
        assign ask_ready = (!busy_q || last_beat[port]) && !(port == 0 && write_valid);
        assign reading[port] = busy_q;
        always_ff @(posedge clk_i) begin
          if (busy_q) begin
            address_q <= address_q + 1'b1;
            beat_q <= beat_q + 1'b1;
          end
          if (!busy_q || last_beat[port]) begin
            busy_q <= ask_valid && ask_ready;
            beat_q <= '0;
            address_q <= AddressBits'((32'(ask_line[LineBits-1:0]) + (ask_line[LineBits] ? GlobalLines : 0)) * Beats);
            tag_q <= ask_tag;
            for (int unsigned g = 0; g < Group; g++) target_q[g] <= ask_source == SourceBits'(g);
          end
          read_target_q <= busy_q ? target_q : '0;
          read_tag_q <= tag_q;
          out_target_q <= read_target_q;
          out_tag_q <= read_tag_q;
          data_q <= read_data[StoredBits*port+:StoredBits];
          if (rst_i) begin
            busy_q <= 1'b0;
            read_target_q <= '0;
            out_target_q <= '0;
          end
        end
        if (Parity != 0) begin : gen_check
          logic beyond_q, read_beyond_q, out_beyond_q;
          always_ff @(posedge clk_i) begin
            if (!busy_q || last_beat[port])
              beyond_q <= 32'(ask_line[LineBits-1:0]) >= (ask_line[LineBits] ? CausticLines : GlobalLines);
            read_beyond_q <= beyond_q;
            out_beyond_q <= read_beyond_q;
          end
          assign wrong = ^data_q || out_beyond_q;
          assign faulty[port] = wrong && out_target_q != '0;
        end else begin : gen_no_check
          assign wrong = 1'b0;
          assign faulty[port] = wrong;
        end
        for (genvar item = 0; item < Items; item++) begin : gen_unpack
          assign raw[BeatBits*port+ItemStride*item+:ItemStride] = ItemStride'(data_q[ItemBits*item+:ItemBits]);
        end
        for (genvar g = 0; g < Group; g++) begin : gen_reply
          localparam int unsigned I = port + Ports * g;
          assign line_rsp_valid_o[I] = out_target_q[g];
          assign line_rsp_tag_o[TagBits*I+:TagBits] = out_tag_q;
          assign line_rsp_data_o[ReplyBits*I+:BeatBits] = raw[BeatBits*port+:BeatBits];
          if (Parity != 0) begin : gen_wrong
            assign line_rsp_data_o[ReplyBits*I+ReplyBits-1] = wrong;
          end
        end
      end
      2: begin : gen_used  // reads a row a cycle
        localparam int unsigned Group = Both ? Gatherers / 2 + 1 : (Gatherers - port + Ports - 1) / Ports;
        localparam int unsigned SourceBits = Group > 1 ? $clog2(Group) : 1;
        logic [Group-1:0] req_valid, req_ready;
        logic [Group*(LineBits+1+TagBits)-1:0] req;
        logic ask_valid, ask_ready;
        logic [LineBits+TagBits:0] ask;
        logic [SourceBits-1:0] ask_source;
        logic [TagBits-1:0] ask_tag;
        /* verilator lint_off UNUSEDSIGNAL */  // stages that are not there AtOnce, nor a bit of the map
        logic [TagBits-1:0] tag_q, read_tag_q;
        logic [LineBits:0] ask_line;
        logic [Group-1:0] target_q, read_target_q;
        logic [AddressBits-1:0] address_q;
        /* verilator lint_on UNUSEDSIGNAL */

        for (genvar g = 0; g < Group; g++) begin : gen_gatherer
          localparam bit AtBoth = Both && g == Group - 1;
          localparam int unsigned I = AtBoth ? Gatherers - 1 : port + Ports * g;
          if (AtBoth) begin : gen_in_turn
            assign req_valid[g] = both_valid[port];
            assign both_ready[port] = req_ready[g];
          end else begin : gen_alone
            assign req_valid[g] = line_req_valid_i[I];
            assign line_req_ready_o[I] = req_ready[g];
          end
          assign req[(LineBits+1+TagBits)*g+:LineBits+1+TagBits] = {
            line_req_addr_i[(LineBits+1)*I+:LineBits+1], line_req_tag_i[TagBits*I+:TagBits]
          };
        end

        arbiter #(
            .Inputs(Group),
            .Width(LineBits + 1 + TagBits)
        ) turns (
            .clk_i(clk_i),
            .rst_i(rst_i),
            .in_valid_i(req_valid),
            .in_ready_o(req_ready),
            .in_i(req),
            .out_valid_o(ask_valid),
            .out_ready_i(ask_ready),
            .out_o(ask),
            .out_source_o(ask_source)
        );
        assign {ask_line, ask_tag} = ask;

        // A word to write takes port a, which then starts no line; one that it was reading is not needed by anybody, since
        // lines change only while no query is in flight.
        assign read_address[AddressBits*port+:AddressBits] = AtOnce ? AddressBits'(ask_line) : address_q;
        if (Rows) begin : gen_row_port
          // A line a cycle, each gatherer's only when the beats of its last one have been read.
          logic [Beats-2:0] started_q[0:Group-1];  // of each gatherer, in the last cycles, the latest lowest
          logic [Group-1:0] sending;
          logic [StoredBits-1:0] row[0:Beats-1];
          /* verilator lint_off UNUSEDSIGNAL */  // AtOnce
          logic asked_beyond_q, read_beyond_q;
          /* verilator lint_on UNUSEDSIGNAL */

          // Where both ports have a line for the same gatherer, port 0 is first.
          if (Both && port == 1) begin : gen_second
            assign ask_ready = !sending[ask_source] && both_waits != '1;
          end else begin : gen_first
            assign ask_ready = !sending[ask_source] && !(port == 0 && write_valid);
          end
          always_comb begin
            for (int unsigned g = 0; g < Group; g++) begin
              sending[g]  = started_q[g] != '0;
              target_q[g] = started_q[g][0];
            end
            if (Both && both_sending != '0) sending[Group-1] = 1'b1;
            for (int unsigned beat = 0; beat < Beats; beat++) row[beat] = read_data[RowBits*port+StoredBits*beat+:StoredBits];
          end
          assign reading[port] = target_q != '0;
          assign last_beat[port] = 1'b1;
          always_ff @(posedge clk_i) begin
            for (int unsigned g = 0; g < Group; g++)
              started_q[g] <= (Beats - 1)'({started_q[g], ask_valid && ask_ready && ask_source == SourceBits'(g)});
            address_q <= AddressBits'(32'(ask_line[LineBits-1:0]) + (ask_line[LineBits] ? GlobalLines : 0));
            tag_q <= ask_tag;
            read_target_q <= target_q;
            read_tag_q <= tag_q;
            if (rst_i) begin
              for (int unsigned g = 0; g < Group; g++) started_q[g] <= '0;
              read_target_q <= '0;
            end
          end
          if (Parity != 0) begin : gen_beyond
            always_ff @(posedge clk_i) begin
              asked_beyond_q <= 32'(ask_line[LineBits-1:0]) >= (ask_line[LineBits] ? CausticLines : GlobalLines);
              read_beyond_q <= asked_beyond_q;
            end
          end else begin : gen_no_beyond
            assign asked_beyond_q = 1'b0;
            assign read_beyond_q  = asked_beyond_q;
          end
          if (Both) begin : gen_to_both
            assign both_waits[port] = ask_valid && ask_source == SourceBits'(Group - 1);
            assign both_starts[port] = AtOnce ? both_waits[port] && ask_ready : target_q[Group-1];
            assign both_sending[port] = started_q[Group-1] != '0;
            assign both_read[port] = AtOnce ? target_q[Group-1] : read_target_q[Group-1];
            assign both_beyond[port] = AtOnce ? asked_beyond_q : read_beyond_q;
            assign both_tag[TagBits*port+:TagBits] = AtOnce ? tag_q : read_tag_q;
          end
          for (genvar g = 0; g < Group - (Both && port == 1 ? 1 : 0); g++) begin : gen_sender
            localparam bit AtBoth = Both && g == Group - 1;
            localparam int unsigned I = AtBoth ? Gatherers - 1 : port + Ports * g;
            logic [BeatNumberBits-1:0] beat_q;  // the next one to leave; 0 where none is under way
            logic [StoredBits-1:0] data_q;
            logic [TagBits-1:0] out_tag_q;
            logic valid_q, beyond_q;

            // What begins, and the beat that leaves, where the gatherer is at both ports.
            /* verilator lint_off UNUSEDSIGNAL */
            logic begins, beyond;
            logic [TagBits-1:0] tag;
            logic [StoredBits-1:0] leaving;
            /* verilator lint_on UNUSEDSIGNAL */
            if (AtBoth) begin : gen_either
              logic from_q;  // the port that the line comes from
              logic [StoredBits-1:0] rows[0:2*Beats-1];
              // The last beat of a line leaves no later than the next line starts.
              always_ff @(posedge clk_i) if (both_starts != '0) from_q <= both_starts[1];
              always_comb for (int unsigned b = 0; b < 2 * Beats; b++) rows[b] = read_data[StoredBits*b+:StoredBits];
              assign begins = both_read != '0;
              assign beyond = both_beyond[from_q];
              assign tag = from_q ? both_tag[TagBits+:TagBits] : both_tag[0+:TagBits];
              assign leaving = rows[(from_q?Beats : 0)+32'(beat_q)];
            end else begin : gen_own
              assign begins = AtOnce ? target_q[g] : read_target_q[g];
              assign beyond = AtOnce ? asked_beyond_q : read_beyond_q;
              assign tag = AtOnce ? tag_q : read_tag_q;
              assign leaving = '0;
            end
            always_ff @(posedge clk_i) begin
              if ((Both ? begins : read_target_q[g]) || beat_q != '0) beat_q <= beat_q == BeatNumberBits'(Beats - 1) ? '0 : beat_q + 1'b1;
              valid_q <= (Both ? begins : read_target_q[g]) || beat_q != '0;
              if (Both ? begins : read_target_q[g]) begin
                out_tag_q <= Both ? tag : read_tag_q;
                beyond_q  <= Both ? beyond : read_beyond_q;
              end
              data_q <= AtBoth ? leaving : row[beat_q];
              if (I == 0 && write_valid) begin
                beat_q  <= write_back ? '0 : write_beat;
                valid_q <= 1'b0;
              end
              if (rst_i) begin
                beat_q  <= '0;
                valid_q <= 1'b0;
              end
            end
            assign line_rsp_valid_o[I] = valid_q;
            assign line_rsp_tag_o[TagBits*I+:TagBits] = out_tag_q;
            assign line_rsp_data_o[ReplyBits*I+:BeatBits] = raw[BeatBits*I+:BeatBits];
            if (Parity != 0) begin : gen_wrong
              assign line_rsp_data_o[ReplyBits*I+ReplyBits-1] = ^data_q || beyond_q;
              assign faulty[I] = valid_q && (^data_q || beyond_q);
            end else begin : gen_no_wrong
              assign faulty[I] = beyond_q;
            end
            for (genvar item = 0; item < Items; item++) begin : gen_unpack
              assign raw[BeatBits*I+ItemStride*item+:ItemStride] = ItemStride'(data_q[ItemBits*item+:ItemBits]);
            end
          end
        end
      end
      default: begin : gen_unused
        /* verilator lint_off UNUSEDSIGNAL */
        logic [RowBits-1:0] unused;
        /* verilator lint_on UNUSEDSIGNAL */
        assign unused = read_data[RowBits*port+:RowBits];
        if (!Rows) begin : gen_no_sender
          assign faulty[port] = 1'b0;
          assign raw[BeatBits*port+:BeatBits] = '0;
        end
        assign reading[port] = 1'b0;
        assign last_beat[port] = 1'b0;
        assign read_address[AddressBits*port+:AddressBits] = '0;
      end
    endcase
  end

  if (Parity != 0) begin : gen_faults
    logic [Senders-1:0] faulty_q;
    logic [31:0] faulty_beats;
    always_comb begin
      faulty_beats = '0;
      for (int unsigned sender = 0; sender < Senders; sender++) faulty_beats = faulty_beats + 32'(faulty_q[sender]);
    end
    always_ff @(posedge clk_i) begin
      faulty_q <= faulty;
      count_faults_o <= count_faults_o + faulty_beats;
      if (rst_i) begin
        faulty_q <= '0;
        count_faults_o <= '0;
      end
    end
  end else begin : gen_no_faults
    /* verilator lint_off UNUSEDSIGNAL */
    logic unused;
    /* verilator lint_on UNUSEDSIGNAL */
    assign unused = &{1'b0, faulty};
    assign count_faults_o = '0;
  end

  // ---- counters ----
  logic [1:0] done_q;
  logic reading_q;
  always_ff @(posedge clk_i) begin
    done_q <= reading & last_beat;
    reading_q <= reading != '0;
    count_lines_o <= count_lines_o + 40'(done_q[0]) + 40'(done_q[1]);
    count_busy_o <= count_busy_o + 40'(reading_q);
    if (rst_i) begin
      done_q <= '0;
      reading_q <= 1'b0;
      count_lines_o <= '0;
      count_busy_o <= '0;
    end
  end
endmodule

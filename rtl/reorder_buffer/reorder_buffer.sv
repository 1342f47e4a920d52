// SPDX-License-Identifier: Apache-2.0
// Gather queries in, the same queries out in a coherent order: a pool of Packets packets linked into Bins bins, drained
// by a sweep or fullest bin first; or a plain register (Key 0). Nothing leaves until Packets are held or a flush has come;
// then one leaves for each that comes. Golden: golden/unit/reorder_buffer.cpp; definition: docs/reorder_buffer.md.
//
// Throughput, once full: sweep one packet a cycle but for 7 cycles once a pass through the bins; fullest n packets in
// n + 3 cycles, n the length of the bin, and no choice sooner than 2 * Levels + 2 cycles after the last; pass-through one
// packet a cycle. Latency from the packet that lets it go to out_valid_o: key (CellBits or 3) + 15 cycles. After reset
// no packet is processed for 4 * Bins + 2 cycles.
module reorder_buffer #(
    parameter int unsigned Key = photonloom_pkg::ReorderKey,  // 0 pass-through, 1 Hilbert, 2 hash
    parameter int unsigned Drain = photonloom_pkg::ReorderDrain,  // 0 sweep, 1 fullest
    parameter int unsigned Packets = photonloom_pkg::ReorderPackets,
    parameter int unsigned Bins = photonloom_pkg::ReorderBins,
    parameter int unsigned CellBits = photonloom_pkg::ReorderCellBits,
    parameter int unsigned PositionBits = photonloom_pkg::PositionBits
) (
    input  logic clk_i,  // clock
    input  logic rst_i,  // reset, synchronous
    input  logic in_valid_i,  // offered
    output logic in_ready_o,  // taken when offered
    input  photonloom_pkg::gather_query_t in_i,  // the packet
    output logic out_valid_o,  // offered
    input  logic out_ready_i,  // taken when offered
    output photonloom_pkg::gather_query_t out_o,  // the packet
    output logic [31:0] count_packets_o,  // packets taken in, flushes included
    output logic [31:0] count_flushes_o,  // flushes taken in
    output logic [31:0] count_cycles_busy_o,  // cycles in which a packet came or went
    output logic [31:0] count_choice_waits_o  // cycles in which a packet had to leave and its bin was not known yet
);
  localparam int unsigned Width = photonloom_pkg::GatherQueryPacketBits;

  // Fields of a packet are read here: some synthesis tools find no fields of what a generate block declares.
  logic in_taken, out_taken, in_flush;
  logic [3*PositionBits-1:0] in_position;
  assign in_taken = in_valid_i && in_ready_o;
  assign out_taken = out_valid_o && out_ready_i;
  assign in_flush = in_i.flush;
  assign in_position = in_i.position;

  counter packets (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .event_i(in_taken),
      .count_o(count_packets_o)
  );
  counter flushes (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .event_i(in_taken && in_flush),
      .count_o(count_flushes_o)
  );
  counter cycles_busy (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .event_i(in_taken || out_taken),
      .count_o(count_cycles_busy_o)
  );

  if (Key == 0) begin : gen_pass_through
    skid_buffer #(
        .Width(Width)
    ) register (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .in_valid_i(in_valid_i),
        .in_ready_o(in_ready_o),
        .in_i(in_i),
        .out_valid_o(out_valid_o),
        .out_ready_i(out_ready_i),
        .out_o(out_o)
    );
    assign count_choice_waits_o = '0;
    logic unused;
    assign unused = &{1'b0, in_position};
  end else begin : gen_reorder
    // Binary searches want at least two bits.
    localparam int unsigned BinBits = $clog2(Bins) > 2 ? $clog2(Bins) : 2;
    localparam int unsigned CountBits = $clog2(Packets + 1);
    localparam int unsigned KeyLatency = Key == 1 ? CellBits : 3;
    localparam int unsigned KeyDepth = 16;  // packets whose key is under way, above KeyLatency + 4
    localparam int unsigned OutDepth = 16;  // above the removal's latency

    // Packets wait in one FIFO while the key pipeline, which never stalls, fills another.
    logic [BinBits-1:0] key_bin, head_bin, bin;
    logic [KeyLatency-1:0] key_valid_q;
    logic wait_ready, wait_valid, head_valid, key_valid, key_ready, join_ready, join_ok, lists_ready, lists_ready_q;
    logic [Width:0] wait_packet;  // the flush bit on top
    logic [Width-1:0] packet;
    logic packet_valid, packet_ready, packet_flush;

    assign in_ready_o = wait_ready;

    fifo #(
        .Width(Width + 1),
        .Depth(KeyDepth)
    ) waiting (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .in_valid_i(in_valid_i),
        .in_ready_o(wait_ready),
        .in_i({in_flush, in_i}),
        .out_valid_o(wait_valid),
        .out_ready_i(join_ok),
        .out_o(wait_packet)
    );

    reorder_key #(
        .Key(Key),
        .PositionBits(PositionBits),
        .CellBits(CellBits),
        .Bins(Bins),
        .BinBits(BinBits)
    ) key (
        .clk_i(clk_i),
        .position_i(in_position),
        .bin_o(key_bin)
    );
    always_ff @(posedge clk_i) begin
      key_valid_q <= KeyLatency'({key_valid_q, in_taken});
      if (rst_i) key_valid_q <= '0;
    end
    assign key_valid = key_valid_q[KeyLatency-1];

    fifo #(
        .Width(BinBits),
        .Depth(KeyDepth)
    ) keys (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .in_valid_i(key_valid),
        .in_ready_o(key_ready),
        .in_i(key_bin),
        .out_valid_o(head_valid),
        .out_ready_i(join_ok),
        .out_o(head_bin)
    );
    assign join_ok = head_valid && wait_valid && lists_ready_q && join_ready;

    skid_buffer_ahead #(
        .Width(BinBits + 1 + Width)
    ) joined (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .in_valid_i(head_valid && wait_valid && lists_ready_q),
        .in_ready_o(join_ready),
        .in_i({head_bin, wait_packet}),
        .out_valid_o(packet_valid),
        .out_ready_i(packet_ready),
        .out_o({bin, packet_flush, packet})
    );

    // One operation a cycle: a removal, an insertion, or both, the removal first. With Packets held a packet leaves and
    // only then may another one enter, so each choice is made among the same packets as in golden.
    localparam int unsigned CreditBits = $clog2(OutDepth + 1);
    logic [CountBits-1:0] held_q, held;
    logic none_held_q, full_q;  // held_q is 0; is Packets
    logic [CreditBits-1:0] credit_q, credit;  // places in the output FIFO that no removal has claimed
    logic credit_any_q;
    logic insert, take_wanted, take_ready, take_alone, take, flush, choice_ready;
    logic [BinBits-1:0] take_bin;

    assign take_wanted = credit_any_q && (full_q || (packet_valid && packet_flush && !none_held_q));
    assign take = take_wanted && take_ready;
    // When full, as a packet that is no flush comes, a take is wanted iff there is credit.
    assign insert = choice_ready && packet_valid && !packet_flush &&
        (!full_q || (credit_any_q && take_ready && !take_alone));
    assign flush = choice_ready && credit_any_q && packet_valid && packet_flush && none_held_q;
    assign packet_ready = insert || flush;
    assign held = insert ? held_q + 1'b1 : held_q - 1'b1;
    assign credit = out_taken ? credit_q + 1'b1 : credit_q - 1'b1;

    if (Drain == 0) begin : gen_sweep
      reorder_sweep #(
          .BinBits(BinBits),
          .CountBits(CountBits)
      ) choice (
          .clk_i(clk_i),
          .rst_i(rst_i),
          .clear_i(flush),
          .ready_o(choice_ready),
          .insert_i(insert),
          .insert_bin_i(bin),
          .full_i(full_q),
          .take_i(take_wanted),
          .take_ready_o(take_ready),
          .take_alone_o(take_alone),
          .bin_o(take_bin)
      );
    end else begin : gen_fullest
      reorder_fullest #(
          .BinBits(BinBits),
          .CountBits(CountBits)
      ) choice (
          .clk_i(clk_i),
          .rst_i(rst_i),
          .clear_i(flush),
          .ready_o(choice_ready),
          .insert_i(insert),
          .insert_bin_i(bin),
          .take_i(take_wanted),
          .take_ready_o(take_ready),
          .take_alone_o(take_alone),
          .bin_o(take_bin)
      );
    end

    counter choice_waits (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .event_i(take_wanted && !take_ready),
        .count_o(count_choice_waits_o)
    );

    // A flush finds all bins empty: it enters one and leaves it again at once.
    logic insert_q, take_q;
    logic [BinBits-1:0] insert_bin_q, take_bin_q;
    logic [Width-1:0] insert_packet_q, leaving;
    logic leaving_valid, out_ready;

    always_ff @(posedge clk_i) begin
      insert_q <= packet_ready;
      insert_bin_q <= bin;
      insert_packet_q <= packet;
      take_q <= take || flush;
      take_bin_q <= flush ? bin : take_bin;
      lists_ready_q <= lists_ready;

      if (insert != take) begin
        held_q <= held;
        none_held_q <= held == '0;
        full_q <= held == CountBits'(Packets);
      end
      if ((take || flush) != out_taken) begin
        credit_q <= credit;
        credit_any_q <= credit != '0;
      end
      if (rst_i) begin
        insert_q <= 1'b0;
        take_q <= 1'b0;
        lists_ready_q <= 1'b0;
        held_q <= '0;
        none_held_q <= 1'b1;
        full_q <= 1'b0;
        credit_q <= CreditBits'(OutDepth);
        credit_any_q <= 1'b1;
      end
    end

    reorder_lists #(
        .Width(Width),
        .Packets(Packets),
        .Bins(Bins),
        .BinBits(BinBits)
    ) lists (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .ready_o(lists_ready),
        .insert_i(insert_q),
        .insert_bin_i(insert_bin_q),
        .insert_packet_i(insert_packet_q),
        .remove_i(take_q),
        .remove_bin_i(take_bin_q),
        .out_valid_o(leaving_valid),
        .out_o(leaving)
    );

    fifo #(
        .Width(Width),
        .Depth(OutDepth)
    ) outgoing (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .in_valid_i(leaving_valid),
        .in_ready_o(out_ready),
        .in_i(leaving),
        .out_valid_o(out_valid_o),
        .out_ready_i(out_ready_i),
        .out_o(out_o)
    );

    // The key FIFO has a place for each packet that waits, the output FIFO for each credit.
`ifdef SYNTHESIS
    logic unused;
    assign unused = &{1'b0, key_ready, out_ready};
`else
    always_ff @(posedge clk_i) begin
      if (!rst_i) assert (!key_valid || key_ready);
      if (!rst_i) assert (!leaving_valid || out_ready);
    end
`endif
  end
endmodule

// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/lut_ram.sv rtl/common/skid_buffer.sv rtl/common/skid_buffer_ahead.sv rtl/common/counter.sv tests/formal/harness/stubs/fifo.sv
// sources: tests/formal/harness/stubs/reorder_key.sv tests/formal/harness/stubs/reorder_choice.sv
// sources: tests/formal/harness/stubs/reorder_lists.sv rtl/reorder_buffer/reorder_buffer.sv
// reorder_buffer that reorders: what comes out is what went in. Two packets are followed, any: x has a 1 in a bit of its own, y,
// sent later, in another one, all others have 0 there. Each leaves once at most, after it was sent, a flush as a flush and others
// as others; x goes into the bin of its key; and if x or y is a flush, x leaves before y. So a flush leaves after all that was
// sent before it, none of which is lost, and before all that was sent after it.
//
// Out is where packets enter the outgoing FIFO, which keeps them (fifo_order) and has room for them (reorder_control); so credit
// is free, and as nothing else depends on when they are taken they are taken at once. In place of key, choice and lists stand
// stubs that do what is proved of them.
module reorder_order #(
    parameter int unsigned Drain = 0,
    parameter int unsigned Packets = 2
) (
    input logic clk_i,
    input logic rst_i,
    input logic in_valid_i,
    input photonloom_pkg::gather_query_t in_i,
    input logic out_ready_i
);
  localparam int unsigned Latency = 3;  // of the key
  localparam int unsigned Bins = 4;
  localparam int unsigned Width = photonloom_pkg::GatherQueryPacketBits;
  localparam int unsigned CountBits = $clog2(Packets + 1);
  localparam int unsigned ListBits = $clog2(Packets + 2);
  localparam int unsigned Words = 4;  // of a FIFO in front

  logic in_ready, out_valid;
  (* keep *) photonloom_pkg::gather_query_t out;
  reorder_buffer #(
      .Key(1),
      .Drain(Drain),
      .Packets(Packets),
      .Bins(Bins),
      .CellBits(Latency),
      .PositionBits(1)
  ) dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(in_valid_i),
      .in_ready_o(in_ready),
      .in_i(in_i),
      .out_valid_o(out_valid),
      .out_ready_i(out_ready_i),
      .out_o(out),
      .count_packets_o(),
      .count_flushes_o(),
      .count_cycles_busy_o(),
      .count_choice_waits_o()
  );

  logic started_q = 1'b0;
  always_ff @(posedge clk_i) started_q <= 1'b1;
  always_comb assume (rst_i == !started_q);

  // Probes: the FIFOs in front, the register behind them, the lists' ports and what they hold, the choice.
  logic [Words-1:0] wait_valid, key_valid, out_words;
  logic [Words*(Width+1)-1:0] wait_words;  // {flush, packet}
  logic [Words*2-1:0] key_words;
  logic [Latency-1:0] key_stages;
  logic [1:0] key_bin;
  logic main_valid, spare_valid;
  logic [Width+2:0] main, spare;  // {bin, flush, packet}
  logic list_insert, list_remove, leaving_valid;
  logic [1:0] list_insert_bin, list_remove_bin;
  logic [Width-1:0] list_packet, leaving;
  logic [1:0] list_follow, list_held;
  logic [3:0] list_bins;
  logic [2*ListBits-1:0] list_ahead;
  logic [17:0] list_leaves;
  logic [2*Width-1:0] list_packets;
  logic [Bins*ListBits-1:0] list_counts;
  logic [Bins*CountBits-1:0] counts;
  logic [CountBits-1:0] held;
  logic none_held, full;

  // Where a packet has the bit of x, that of y above it, and whether it is a flush.
  localparam int unsigned Mark = Width - 2;
  localparam int unsigned Flush = Width - 3;

  logic taken;
  assign taken = in_valid_i && in_ready;
  logic [1:0] sent_q, gone_q, flush_q;
  logic [2:0] age_q;  // cycles since x was sent, Latency + 1 and more alike
  (* anyconst *) logic [1:0] key;  // of x
  always_ff @(posedge clk_i) begin
    for (int unsigned f = 0; f < 2; f++) begin
      if (taken && in_i.tag[f]) begin
        sent_q[f]  <= 1'b1;
        flush_q[f] <= in_i.flush;
      end
      if (leaving_valid && leaving[Mark+f]) gone_q[f] <= 1'b1;
    end
    age_q <= taken && in_i.tag[0] ? 3'd1 : age_q == '0 || age_q == 3'(Latency + 1) ? age_q : age_q + 3'd1;
    if (rst_i) begin
      sent_q <= '0;
      gone_q <= '0;
      age_q  <= '0;
    end
  end
  always_comb begin
    if (taken) begin
      assume ((in_i.tag & sent_q) == '0 && in_i.tag != 2'd3);
      if (in_i.tag[1]) assume (sent_q[0] && (in_i.flush || flush_q[0]));
    end
    assume (out_ready_i);
    if (age_q == 3'(Latency)) assume (key_bin == key);
    // The lists follow x and y; what else they give out is neither.
    if (list_insert) assume (list_follow == list_packet[Mark+:2]);
    if (leaving_valid) assume ((leaving[Mark+:2] & ~{list_leaves[17], list_leaves[8]}) == '0);
  end

  // What is to be shown.
  always_comb begin
    if (!rst_i && started_q) begin
      for (int unsigned f = 0; f < 2; f++) begin
        if (leaving_valid && leaving[Mark+f]) assert (sent_q[f] && !gone_q[f] && leaving[Flush] == flush_q[f]);
      end
      if (leaving_valid && leaving[Mark+1]) assert (gone_q[0]);
      if (list_insert && list_packet[Mark]) assert (list_insert_bin == key);
    end
  end

  // Lemmas. The places of x and of y, from the output on: lists, their entrance, the register, the FIFO. A packet that was sent
  // and has not left is in one of them, x nearer to the output than y.
  localparam int unsigned Places = 9 + 1 + 1 + 2 + Words;
  logic [Places-1:0] x_at, y_at;
  logic [2*Places-1:0] at;
  for (genvar f = 0; f < 2; f++) begin : gen_at
    for (genvar i = 0; i < 9; i++) begin : gen_leaving
      assign at[Places*f+i] = list_leaves[9*f+8-i];
    end
    assign at[Places*f+9] = list_held[f];
    assign at[Places*f+10] = list_insert && list_packet[Mark+f];
    assign at[Places*f+11] = main_valid && main[Mark+f];
    assign at[Places*f+12] = spare_valid && spare[Mark+f];
    for (genvar i = 0; i < Words; i++) begin : gen_waiting
      assign at[Places*f+13+i] = wait_valid[i] && wait_words[(Width+1)*i+Mark+f];
    end
  end
  assign {y_at, x_at} = at;
  for (genvar f = 0; f < 2; f++) begin : gen_places
    logic [Places-1:0] here;
    assign here = at[Places*f+:Places];
    always_comb begin
      if (!rst_i && started_q) begin
        assert ((here & (here - Places'(1))) == '0 && (here != '0) == (sent_q[f] && !gone_q[f]));
        if (gone_q[f]) assert (sent_q[f]);
        // Its flush bits, and no flush stays in the lists.
        for (int unsigned i = 0; i < Words; i++) begin
          if (here[13+i]) assert (wait_words[(Width+1)*i+Width] == flush_q[f] && wait_words[(Width+1)*i+Flush] == flush_q[f]);
        end
        if (here[12]) assert (spare[Width] == flush_q[f] && spare[Flush] == flush_q[f]);
        if (here[11]) assert (main[Width] == flush_q[f] && main[Flush] == flush_q[f]);
        if (here[10]) assert (list_packet[Flush] == flush_q[f]);
        if (here[10] && flush_q[f]) begin
          assert (list_remove && list_remove_bin == list_insert_bin && list_counts == '0 && counts == '0);
        end
        if (here[9]) assert (!flush_q[f] && list_ahead[ListBits*f+:ListBits] < list_counts[ListBits*list_bins[2*f+:2]+:ListBits]);
        if (here[9:0] != '0) assert (list_packets[Width*f+Flush] == flush_q[f] && list_packets[Width*f+Mark+:2] == 2'd1 << f);
      end
    end
  end
  always_comb begin
    if (!rst_i && started_q) begin
      if (sent_q[1]) assert (sent_q[0] && (flush_q != '0));
      if (gone_q[1]) assert (gone_q[0]);
      // The lowest bit of either: x's is the lower one.
      if (sent_q[1] && !gone_q[0]) assert (!gone_q[1] && x_at < y_at);
    end
  end

  // A key comes to the place of its packet.
  function automatic logic [2:0] ones(input logic [Words-1:0] bits);
    ones = 3'(bits[0]) + 3'(bits[1]) + 3'(bits[2]) + 3'(bits[3]);
  endfunction
  always_comb begin
    if (!rst_i && started_q) begin
      assert ((wait_valid & (wait_valid + Words'(1))) == '0 && (key_valid & (key_valid + Words'(1))) == '0);
      assert (ones(wait_valid) == ones(key_valid) + ones(Words'(key_stages)));
      assert (age_q <= 3'(Latency + 1) && (age_q != '0) == sent_q[0]);
      for (int unsigned a = 1; a <= Latency; a++) if (age_q == 3'(a)) assert (key_stages[a-1]);
      for (int unsigned i = 0; i < Words; i++) begin
        if (x_at[13+i] && age_q == 3'(Latency + 1)) assert (key_valid[i] && key_words[2*i+:2] == key);
        if (x_at[13+i] && age_q <= 3'(Latency)) assert (3'(i) == ones(key_valid) + ones(Words'(key_stages >> age_q)));
      end
      if (age_q != '0 && age_q <= 3'(Latency)) assert (x_at[13+:Words] != '0);
      if (x_at[12]) assert (spare[Width+1+:2] == key);
      if (x_at[11]) assert (main[Width+1+:2] == key);
      if (x_at[9]) assert (list_bins[1:0] == key);
      if (spare_valid) assert (main_valid);
      assert (out_words[Words-1:1] == '0);
    end
  end

  // How many are held.
  logic [4:0] sum;
  always_comb begin
    sum = '0;
    for (int unsigned b = 0; b < Bins; b++) sum = sum + 5'(counts[CountBits*b+:CountBits]);
    if (!rst_i && started_q) begin
      assert (5'(held) == sum && sum <= 5'(Packets));
      assert (none_held == (held == '0) && full == (held == CountBits'(Packets)));
      for (int unsigned b = 0; b < Bins; b++) begin
        assert (ListBits'(counts[CountBits*b+:CountBits]) == ListBits'(list_counts[ListBits*b+:ListBits] +
            ListBits'(list_insert && list_insert_bin == 2'(b)) - ListBits'(list_remove && list_remove_bin == 2'(b))));
        assert (list_counts[ListBits*b+:ListBits] <= ListBits'(Packets));
      end
      for (int unsigned n = 0; n < 9; n++) if (list_leaves[n] || list_leaves[9+n]) assert (list_stages[n]);
    end
  end
  logic [8:0] list_stages;  // probe: removals, bit n is cycle n + 1
endmodule

// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/lut_ram.sv rtl/common/fifo.sv rtl/common/skid_buffer.sv rtl/common/skid_buffer_ahead.sv rtl/common/counter.sv
// sources: tests/formal/harness/stubs/reorder_key.sv tests/formal/harness/stubs/reorder_choice.sv
// sources: tests/formal/harness/stubs/reorder_lists.sv rtl/reorder_buffer/reorder_buffer.sv
// reorder_buffer that reorders: what it promises to its parts. The choice (reorder_choice): an insertion comes with a take that
// admits one when the pool is full, without a take else; a take is held until taken; it is cleared only when nothing is held; no
// bin holds more than Packets. The lists (reorder_lists_order, reorder_counts_turns): nothing before they are ready, a removal
// only from a bin that holds something, at most Packets in the pool; of free_list (free_list_numbers): at most Packets + 12
// numbers are out. A key finds its place in its FIFO, and what leaves the one that it claimed.
//
// Progress: no deadlock. A cycle counts if the consumer is ready, the lists are and the choice is not waited for: lists are ready
// soon after reset (reorder_lists_order), the choice after 8 cycles at most (reorder_choice). A limited number of these cycles,
// in which Packets can leave, is what each of the following waits for at most: the packet that is next to enter the pool, or the
// flush that is next to pass, which waits until all that is held has left; the packet that is next in the FIFO; a packet that is
// offered when that is full.
//
// In place of key, choice and lists stand stubs that do what is proved of them. The environment offers and takes at any time.
module reorder_control #(
    parameter int unsigned Drain = 0,
    parameter int unsigned Packets = 3,
    parameter int unsigned Progress = 0
) (
    input logic clk_i,
    input logic rst_i,
    input logic in_valid_i,
    input photonloom_pkg::gather_query_t in_i,
    input logic out_ready_i
);
  localparam int unsigned Latency = 3;  // of the key
  localparam int unsigned Bins = 4;
  localparam int unsigned CountBits = $clog2(Packets + 1);
  localparam int unsigned ListBits = $clog2(Packets + 2);  // an insertion counts before the removal of its cycle

  logic in_ready, out_valid;
  photonloom_pkg::gather_query_t out;
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

  // Probes.
  logic ready, clear, insert, full, take, take_ready, take_alone;  // the choice's ports
  logic [1:0] insert_bin, take_bin;
  logic [Bins*CountBits-1:0] counts;
  logic lists_ready, list_insert, list_remove;  // the lists' ports
  logic [1:0] list_insert_bin, list_remove_bin;
  logic [8:0] list_stages;
  logic [Bins*ListBits-1:0] list_counts;
  logic key_valid, key_ready, leaving_valid, leaving_ready;
  logic [Latency-1:0] key_stages;
  logic [4:0] wait_head, wait_tail, key_head, key_tail, out_head, out_tail;
  logic lists_ready_q, main_valid, spare_valid;
  logic [CountBits-1:0] held;
  logic none_held;
  logic [4:0] credit;
  logic credit_any;

  logic taken;
  assign taken = take && take_ready;

  // The choice.
  logic pending_q;
  always_ff @(posedge clk_i) pending_q <= take && !take_ready && !rst_i;
  always_comb begin
    if (!rst_i && started_q) begin
      if (insert) assert (ready && (full ? taken && !take_alone : !take));
      if (insert) assert (counts[CountBits*insert_bin+:CountBits] != CountBits'(Packets) || (taken && take_bin == insert_bin));
      if (pending_q) assert (take);
      if (clear) assert (counts == '0 && !insert && !take && ready);
      if (take) assert (counts != '0);
    end
  end

  // The lists: those of any bin, and all.
  (* anyconst *) logic [1:0] watched;
  logic inserted, removed;
  logic [ListBits-1:0] list_count, list_held;
  assign inserted = list_insert && list_insert_bin == watched;
  assign removed = list_remove && list_remove_bin == watched;
  assign list_count = list_counts[ListBits*watched+:ListBits];
  assign list_held = list_counts[0+:ListBits] + list_counts[ListBits+:ListBits] + list_counts[2*ListBits+:ListBits] +
      list_counts[3*ListBits+:ListBits];
  logic [4:0] claimed_q;  // numbers of the free list, asked for and not given back
  always_ff @(posedge clk_i) claimed_q <= rst_i ? '0 : claimed_q + 5'(list_insert) - 5'(list_stages[7]);
  always_comb begin
    if (!rst_i && started_q) begin
      if (list_insert || list_remove) assert (lists_ready);
      if (removed) assert (list_count != '0 || inserted);
      if (inserted) assert (list_count < ListBits'(Packets) || removed);
      if (list_insert) assert (list_held < ListBits'(Packets) || list_remove);
      if (list_insert) assert (claimed_q < 5'(Packets + 12));
      if (list_stages[7]) assert (claimed_q != '0);
    end
  end

  // Nothing overflows.
  always_comb begin
    if (!rst_i && started_q) begin
      if (key_valid) assert (key_ready);
      if (leaving_valid) assert (leaving_ready);
    end
  end

  // Lemmas: what is counted twice agrees.
  logic [4:0] under_way, leaving;  // keys; packets between the choice and the outgoing FIFO
  always_comb begin
    under_way = '0;
    for (int unsigned i = 0; i < Latency; i++) under_way = under_way + 5'(key_stages[i]);
    leaving = 5'(list_remove);
    for (int unsigned i = 0; i < 9; i++) leaving = leaving + 5'(list_stages[i]);
  end
  logic [4:0] sum, list_sum;
  always_comb begin
    sum = '0;
    list_sum = '0;
    for (int unsigned b = 0; b < Bins; b++) begin
      sum = sum + 5'(counts[CountBits*b+:CountBits]);
      list_sum = list_sum + 5'(list_counts[ListBits*b+:ListBits]);
    end
  end
  always_comb begin
    if (!rst_i && started_q) begin
      assert (5'(held) == sum && sum <= 5'(Packets));
      assert (none_held == (held == '0) && full == (held == CountBits'(Packets)));
      for (int unsigned b = 0; b < Bins; b++) begin
        assert (ListBits'(counts[CountBits*b+:CountBits]) == ListBits'(list_counts[ListBits*b+:ListBits] +
            ListBits'(list_insert && list_insert_bin == 2'(b)) - ListBits'(list_remove && list_remove_bin == 2'(b))));
      end
      assert (list_sum <= 5'(Packets));
      assert (claimed_q == list_sum + leaving - 5'(list_remove) - 5'(list_stages[8]));
      assert (5'(wait_tail - wait_head) == 5'(key_tail - key_head) + under_way);
      assert (5'(wait_tail - wait_head) <= 5'd16);
      assert ({1'b0, credit} + {1'b0, 5'(out_tail - out_head)} + {1'b0, leaving} == 6'd16);
      assert (credit_any == (credit != '0));
      if (spare_valid) assert (main_valid);
      if (!lists_ready) assert (!lists_ready_q);
      if (!lists_ready_q) assert (!main_valid && !spare_valid && held == '0 && !list_insert && !list_remove);
    end
  end

  // Each wait, and how long it can still be: both together never exceed the limit.
  logic main_flush, main_taken, joins;  // probes
  if (Progress == 1) begin : gen_progress
    // A take frees no place in the outgoing FIFO, and another one comes free after 11 cycles.
    localparam int unsigned Take = 12;
    localparam int unsigned MainLimit = 1 + Take * Packets + Take - 1;
    localparam int unsigned WaitLimit = Latency + MainLimit + 1;
    logic [7:0] to_credit, to_key, main_left, wait_left;  // cycles
    always_comb begin
      to_credit = 8'd11;
      for (int unsigned i = 0; i < 9; i++) if (list_stages[i]) to_credit = 8'(10 - i);
      if (out_valid) to_credit = 8'd1;
      if (credit_any) to_credit = '0;
      to_key = 8'(Latency);
      for (int unsigned i = 0; i < Latency; i++) if (key_stages[i]) to_key = 8'(Latency - i);
      if (key_head != key_tail) to_key = '0;
      main_left = 8'd1 + to_credit + (main_flush ? 8'(Take) * 8'(held) : full ? 8'(Take) : '0);
      wait_left = 8'd1 + to_key + (spare_valid ? main_left : '0);
    end

    logic counted;
    logic [7:0] main_waits_q, wait_waits_q, refused_q;
    assign counted = out_ready_i && lists_ready_q && ready && !(take && !take_ready);
    always_ff @(posedge clk_i) begin
      main_waits_q <= !main_valid || main_taken ? '0 : main_waits_q + 8'(counted);
      wait_waits_q <= wait_head == wait_tail || joins ? '0 : wait_waits_q + 8'(counted);
      refused_q <= !in_valid_i || in_ready ? '0 : refused_q + 8'(counted);
      if (rst_i) begin
        main_waits_q <= '0;
        wait_waits_q <= '0;
        refused_q <= '0;
      end
    end
    always_comb begin
      if (!rst_i && started_q) begin
        assert (main_waits_q < 8'(MainLimit) && wait_waits_q < 8'(WaitLimit) && refused_q <= 8'(WaitLimit));
        if (main_valid) assert (main_waits_q + main_left <= 8'(MainLimit));
        else assert (main_waits_q == '0);
        if (wait_head != wait_tail) assert (wait_waits_q + wait_left <= 8'(WaitLimit));
        else assert (wait_waits_q == '0);
        if (!in_ready) assert (refused_q + wait_left <= 8'(WaitLimit));
      end
    end
  end
endmodule

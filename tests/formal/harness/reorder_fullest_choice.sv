// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/lut_ram.sv rtl/reorder_buffer/reorder_fullest.sv
// The choice of the bin that the next packet leaves, fullest bin first. One bin, any, is watched with the packets that it
// holds: it is never chosen while it is empty, and while it is not, a choice is there within Limit cycles (no deadlock).
// The choice is at least as full as the watched bin, and its length is the bin's; so with something held the choice holds
// something, which is assumed of the other bins where the watched one is empty (each bin is watched in some run, so by
// induction over the choices it is so).
// The environment is the reorder buffer: a take is held until taken; when the pool is full an insertion comes with a take,
// else without; what is held is cleared only when nothing is.
module reorder_fullest_choice #(
    parameter int unsigned Packets = 2,
    parameter int unsigned Limit = 8
) (
    input logic clk_i,
    input logic rst_i,
    input logic clear_i,
    input logic insert_i,
    input logic [1:0] insert_bin_i,
    input logic take_i,
    input logic full_i
);
  localparam int unsigned BinBits = 2;
  localparam int unsigned CountBits = $clog2(Packets + 1);

  (* anyconst *) logic [BinBits-1:0] watched;
  logic ready, take_ready, take_alone, taken;
  logic [BinBits-1:0] bin;

  reorder_fullest #(
      .BinBits(BinBits),
      .CountBits(CountBits)
  ) dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .clear_i(clear_i),
      .ready_o(ready),
      .insert_i(insert_i),
      .insert_bin_i(insert_bin_i),
      .take_i(take_i),
      .take_ready_o(take_ready),
      .take_alone_o(take_alone),
      .bin_o(bin)
  );

  logic started_q = 1'b0;
  always_ff @(posedge clk_i) started_q <= 1'b1;
  always_comb assume (rst_i == !started_q);

  assign taken = take_i && take_ready;
  logic in, out;
  assign in  = insert_i && insert_bin_i == watched;
  assign out = taken && bin == watched;

  logic [CountBits-1:0] count_q;  // packets in the watched bin
  logic [3:0] waited_q;
  logic pending_q;
  always_ff @(posedge clk_i) begin
    count_q <= count_q + CountBits'(in) - CountBits'(out);
    waited_q <= (take_i && !take_ready && count_q != '0) || !ready ? waited_q + 1'b1 : '0;
    pending_q <= take_i && !take_ready && !rst_i;
    if (rst_i) begin
      count_q  <= '0;
      waited_q <= '0;
    end
  end

  always_comb begin
    if (!rst_i && insert_i) assume (ready && (full_i ? taken && !take_alone : !take_i));
    if (!rst_i && in) assume (count_q != CountBits'(Packets) || out);
    if (!rst_i && pending_q) assume (take_i);
    if (!rst_i && clear_i) assume (count_q == '0 && !insert_i && !take_i && ready);
  end

  always_comb begin
    if (!rst_i) begin
      if (out) assert (count_q != '0);
      assert (waited_q <= 4'(Limit));
    end
  end

  // What is chosen, from inside.
  logic choose;  // probe
  logic [CountBits-1:0] chosen_rest;  // probe
  logic [CountBits-1:0] chosen;
  assign chosen = chosen_rest + 1'b1;
  always_comb begin
    if (!rst_i && choose) begin
      if (count_q == '0) assume (chosen != '0);
      assert (chosen >= count_q);
      if (bin == watched) assert (chosen == count_q);
    end
  end
endmodule

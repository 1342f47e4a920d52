// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/block_ram.sv rtl/common/ram_fifo.sv tests/formal/harness/stream_checks.sv
// ram_fifo keeps the laws of a stream, from reset and from each clear_i on; room_o promises no word too many and empty_o
// is 1 only where no word is inside.
module ram_fifo_stream #(
    parameter int unsigned Depth = 2,
    parameter int unsigned Order = 1,
    parameter int unsigned Law = 1,
    parameter int unsigned Progress = 1,
    parameter int unsigned Room = 0
) (
    input logic clk_i,
    input logic rst_i,
    input logic clear_i,
    input logic in_valid_i,
    input logic in_i,
    input logic out_ready_i
);
  localparam int unsigned AddressBits = $clog2(Depth);
  logic in_ready, out_valid, out, empty;
  logic [AddressBits:0] room;

  ram_fifo #(
      .Width(1),
      .Depth(Depth)
  ) dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .clear_i(clear_i),
      .in_valid_i(in_valid_i),
      .in_ready_o(in_ready),
      .in_i(in_i),
      .out_valid_o(out_valid),
      .out_ready_i(out_ready_i),
      .out_o(out),
      .room_o(room),
      .empty_o(empty)
  );

  logic started_q = 1'b0;
  always_ff @(posedge clk_i) started_q <= 1'b1;
  always_comb assume (rst_i == !started_q);

  stream_checks #(
      .Order(Order),
      .Law(Law),
      .Progress(Progress),
      .Limit(Depth + 3)
  ) checks (
      .clk_i(clk_i),
      .rst_i(rst_i || clear_i),
      .in_valid_i(in_valid_i),
      .in_ready_i(in_ready),
      .in_i(in_i),
      .out_valid_i(out_valid),
      .out_ready_i(out_ready_i),
      .out_i(out)
  );

  if (Room == 1) begin : gen_room
    // Words that came since one cycle, and words inside.
    logic [AddressBits+1:0] inside_q;
    logic [AddressBits:0] promised_q;
    always_ff @(posedge clk_i) begin
      inside_q <= inside_q + (AddressBits + 2)'(in_valid_i && in_ready) - (AddressBits + 2)'(out_valid && out_ready_i);
      // A promise is used up by what comes, and made anew by room_o.
      promised_q <= in_valid_i && promised_q != '0 ? promised_q - 1'b1 : promised_q;
      if (room > promised_q - (AddressBits + 1)'(in_valid_i && promised_q != '0))
        promised_q <= room - (AddressBits + 1)'(in_valid_i && room != '0);
      if (rst_i || clear_i) begin
        inside_q   <= '0;
        promised_q <= '0;
      end
    end
    always_comb begin
      if (!rst_i && !clear_i) begin
        if (promised_q != '0 || room != '0) assert (in_ready);
        assert (empty == (inside_q == '0));
      end
    end
  end
endmodule

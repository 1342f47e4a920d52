// SPDX-License-Identifier: Apache-2.0
// First in, first out, in block RAM; Depth a power of two, at least 2. Holds Depth words in the memory and two more in
// registers behind it. Latency 3, one word a cycle; in_ready_o, out_valid_o and out_o come from registers. room_o is how
// many words may come for certain (the words in the registers are not counted), as of the cycle before. clear_i empties it.
module ram_fifo #(
    parameter int unsigned Width = 8,
    parameter int unsigned Depth = 512,
    localparam int unsigned AddressBits = $clog2(Depth)
) (
    input  logic                 clk_i,
    input  logic                 rst_i,
    input  logic                 clear_i,
    input  logic                 in_valid_i,
    output logic                 in_ready_o,
    input  logic [    Width-1:0] in_i,
    output logic                 out_valid_o,
    input  logic                 out_ready_i,
    output logic [    Width-1:0] out_o,
    output logic [AddressBits:0] room_o,
    output logic                 empty_o      // nothing anywhere
);
  if (Depth < 2 || (1 << AddressBits) != Depth) begin : gen_bad_depth
    ram_fifo_depth_must_be_a_power_of_two_of_at_least_2 bad_depth ();
  end

  logic [AddressBits:0] head_q, tail_q;
  logic fetched_q, push, fetch, take;
  logic [Width-1:0] fetched;

  assign in_ready_o = head_q != {~tail_q[AddressBits], tail_q[AddressBits-1:0]};
  assign push = in_valid_i && in_ready_o;
  assign take = !out_valid_o || out_ready_i;
  assign fetch = head_q != tail_q && (!fetched_q || take);
  assign empty_o = head_q == tail_q && !fetched_q && !out_valid_o;

  block_ram #(
      .Width(Width),
      .Depth(Depth)
  ) store (
      .clk_i(clk_i),
      .write_i(push),
      .write_address_i(tail_q[AddressBits-1:0]),
      .write_data_i(in_i),
      .read_i(fetch),
      .read_address_i(head_q[AddressBits-1:0]),
      .read_data_o(fetched)
  );

  always_ff @(posedge clk_i) begin
    room_o <= (AddressBits + 1)'(Depth) - (tail_q - head_q) - (AddressBits + 1)'(push);
    if (push) tail_q <= tail_q + 1'b1;
    if (fetch) head_q <= head_q + 1'b1;
    if (fetch) fetched_q <= 1'b1;
    else if (take) fetched_q <= 1'b0;
    if (take) begin
      out_valid_o <= fetched_q;
      out_o <= fetched;
    end
    if (rst_i || clear_i) begin
      head_q <= '0;
      tail_q <= '0;
      fetched_q <= 1'b0;
      out_valid_o <= 1'b0;
      room_o <= (AddressBits + 1)'(Depth);
    end
  end
endmodule

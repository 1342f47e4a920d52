// SPDX-License-Identifier: Apache-2.0
// First in, first out, from one clock to another; Depth a power of two, at least 4. Pointers cross in Gray code through two
// registers, words stay in LUT RAM until their pointer has crossed. Both sides are reset together (reset_bridge).
// Latency 1 cycle of the writer and 2 to 3 of the reader; one word a cycle of the slower clock as long as Depth covers the
// pointers' way there and back, 6 cycles.
module async_fifo #(
    parameter int unsigned Width = 8,
    parameter int unsigned Depth = 16
) (
    input  logic             in_clk_i,
    input  logic             in_rst_i,
    input  logic             in_valid_i,
    output logic             in_ready_o,
    input  logic [Width-1:0] in_i,
    input  logic             out_clk_i,
    input  logic             out_rst_i,
    output logic             out_valid_o,
    input  logic             out_ready_i,
    output logic [Width-1:0] out_o
);
  localparam int unsigned AddressBits = $clog2(Depth);

  if (Depth < 4 || (1 << AddressBits) != Depth) begin : gen_bad_depth
    async_fifo_depth_must_be_a_power_of_two_of_at_least_4 bad_depth ();
  end

  // Binary pointers of each side, their Gray codes, and those as the other side sees them.
  logic [AddressBits:0] tail_q, tail_gray_q, tail_meta_q, tail_seen_q;
  logic [AddressBits:0] head_q, head_gray_q, head_meta_q, head_seen_q;
  logic [AddressBits:0] tail_next, head_next;
  logic push, pop;

  assign push = in_valid_i && in_ready_o;
  assign pop = out_valid_o && out_ready_i;
  assign tail_next = tail_q + (AddressBits + 1)'(push);
  assign head_next = head_q + (AddressBits + 1)'(pop);
  // Full: the Gray codes differ in the two top bits alone.
  assign in_ready_o = tail_gray_q != {~head_seen_q[AddressBits:AddressBits-1], head_seen_q[AddressBits-2:0]};
  assign out_valid_o = head_gray_q != tail_seen_q;

  always_ff @(posedge in_clk_i) begin
    tail_q <= tail_next;
    tail_gray_q <= tail_next ^ (tail_next >> 1);
    head_meta_q <= head_gray_q;
    head_seen_q <= head_meta_q;
    if (in_rst_i) begin
      tail_q <= '0;
      tail_gray_q <= '0;
      head_meta_q <= '0;
      head_seen_q <= '0;
    end
  end

  always_ff @(posedge out_clk_i) begin
    head_q <= head_next;
    head_gray_q <= head_next ^ (head_next >> 1);
    tail_meta_q <= tail_gray_q;
    tail_seen_q <= tail_meta_q;
    if (out_rst_i) begin
      head_q <= '0;
      head_gray_q <= '0;
      tail_meta_q <= '0;
      tail_seen_q <= '0;
    end
  end

  lut_ram #(
      .Width(Width),
      .Depth(Depth)
  ) store (
      .clk_i(in_clk_i),
      .write_i(push),
      .write_address_i(tail_q[AddressBits-1:0]),
      .write_data_i(in_i),
      .read_address_i(head_q[AddressBits-1:0]),
      .read_data_o(out_o)
  );
endmodule
